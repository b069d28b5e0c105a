#include "core/remesh/border_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/measure/point_cloud.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

constexpr std::size_t kLeastOnBorder = 3;              // of one loop
constexpr std::size_t kNear = 8;                       // points that tell how dense they are
constexpr std::size_t kStandIns = 32;                  // nearest points of which one is taken
constexpr double kMostPieces = 1000;                   // of an edge
constexpr double kCornerCosine = 0.70710678118654752;  // of 45 degrees
constexpr double kReach = 0.75;  // of the distance to the next point: how far a corner sees along its border
constexpr double kGolden = 0.61803398874989485;

class BorderPlacer {
 public:
  BorderPlacer(const TriangleMesh& mesh, std::span<const Vec3d> positions)
      : mesh_(mesh), count_(positions.size()), cloud_(positions, bounding_box(mesh)), taken_(positions.size(), false) {}

  /// `start`: a halfedge on a border.
  void place_on(std::uint32_t start, BorderPoints& out) {
    list_loop(start);
    const std::vector<std::size_t> corners = find_corners();
    for (const std::size_t corner : corners) {
      out.corners.push_back(mesh_.from(loop_[corner]));
      take_nearest(point_on(loop_[corner], 0), out);
    }
    if (corners.empty()) {
      place_between(0, loop_.size(), kLeastOnBorder, false, out);
    } else {
      const std::size_t least = corners.size() < kLeastOnBorder ? kLeastOnBorder - 1 : 0;
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const std::size_t next = c + 1 < corners.size() ? corners[c + 1] : corners[0] + loop_.size();
        place_between(corners[c], next, least, true, out);
      }
    }
    // Borders may lie on one another, where repair has opened an edge of many faces: their points must not.
    phase_ += kGolden - (phase_ + kGolden >= 1 ? 1 : 0);
  }

 private:
  /// A part of an edge, from `first` to `last` of its length, and where it lies along the border in steps from point to point.
  struct Piece {
    std::uint32_t halfedge;
    double first, last, begin, end;
  };

  Vec3d point_on(std::uint32_t h, double part) const {
    const Vec3d& a = mesh_.positions[mesh_.from(h)];
    return a + part * (mesh_.positions[mesh_.to(h)] - a);
  }

  /// The distance of neighbours in a hexagonal lattice as dense as the points here, which lie on one side of the border only.
  double spacing(const Vec3d& position) {
    near_.resize(std::min(kNear, count_));
    cloud_.tree.nearest(cloud_.local(position), near_);
    const double r = cloud_.distance(near_.back());
    const double area = 0.5 * std::numbers::pi * r * r / (static_cast<double>(near_.size()) - 0.5);
    return std::sqrt(2 / std::numbers::sqrt3 * area);
  }

  void list_loop(std::uint32_t start) {
    loop_.clear();
    along_.assign(1, 0.0);
    std::uint32_t h = start;
    do {
      loop_.push_back(h);
      along_.push_back(along_.back() + (point_on(h, 1) - point_on(h, 0)).norm());
      h = next_on_border(mesh_.twins, h);
    } while (h != start);
  }

  /// The place on the loop so far along it, which may be below zero or beyond the loop's length.
  Vec3d point_along(double at) const {
    at -= std::floor(at / along_.back()) * along_.back();
    const auto edge = static_cast<std::size_t>(std::upper_bound(along_.begin() + 1, along_.end() - 1, at) - along_.begin() - 1);
    const double length = along_[edge + 1] - along_[edge];
    return point_on(loop_[edge], length > 0 ? std::clamp((at - along_[edge]) / length, 0.0, 1.0) : 0);
  }

  /// The vertices of the loop at which it turns enough, and the most as far as they see.
  std::vector<std::size_t> find_corners() {
    const std::size_t n = loop_.size();
    std::vector<double> cosine(n), reach(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d at = point_on(loop_[i], 0);
      reach[i] = std::min(kReach * spacing(at), along_.back() / 4);
      const Vec3d before = at - point_along(along_[i] - reach[i]), after = point_along(along_[i] + reach[i]) - at;
      const double lengths = before.norm() * after.norm();
      cosine[i] = lengths > 0 ? before.dot(after) / lengths : 1;
    }
    const auto is_sharpest = [&](std::size_t i, std::size_t step) {  // one way round
      double way = 0;
      for (std::size_t k = i, count = 1; count < n; ++count) {
        const std::size_t next = (k + step) % n, edge = step == 1 ? k : next;
        way += along_[edge + 1] - along_[edge];
        if (way > reach[i]) break;
        if (cosine[next] < cosine[i] || (cosine[next] == cosine[i] && next < i)) return false;
        k = next;
      }
      return true;
    };
    std::vector<std::size_t> corners;
    for (std::size_t i = 0; i < n; ++i) {
      if (cosine[i] < kCornerCosine && is_sharpest(i, 1) && is_sharpest(i, n - 1)) corners.push_back(i);
    }
    return corners;
  }

  /// Places points on edges [first, last) of the loop, counted on beyond its end, so many at least. `between_ends`: both ends are
  /// points themselves.
  void place_between(std::size_t first, std::size_t last, std::size_t least, bool between_ends, BorderPoints& out) {
    pieces_.clear();
    double sum = 0;
    for (std::size_t i = first; i < last; ++i) add_pieces(loop_[i % loop_.size()], sum);
    const auto steps = static_cast<std::size_t>(std::llround(sum));
    const std::size_t wanted = std::max(least, between_ends && steps > 0 ? steps - 1 : steps);
    const double step = sum / static_cast<double>(between_ends ? wanted + 1 : wanted);
    std::size_t piece = 0;
    for (std::size_t i = 0; i < wanted; ++i) {
      const double at = (static_cast<double>(i) + (between_ends ? 1 : phase_)) * step;
      while (piece + 1 < pieces_.size() && pieces_[piece].end <= at) ++piece;
      const Piece& on = pieces_[piece];
      const double length = on.end - on.begin, within = length > 0 ? std::clamp((at - on.begin) / length, 0.0, 1.0) : 0.5;
      // Clear of the edge's ends, where vertices are that will go.
      const double part = std::clamp(on.first + within * (on.last - on.first), 1e-6, 1 - 1e-6);
      out.places.push_back({mesh_.from(on.halfedge), part});
      take_nearest(point_on(on.halfedge, part), out);
    }
  }

  void add_pieces(std::uint32_t h, double& sum) {
    const double length = (point_on(h, 1) - point_on(h, 0)).norm();
    const auto count = static_cast<int>(std::clamp(std::ceil(length / spacing(point_on(h, 0.5))), 1.0, kMostPieces));
    for (int i = 0; i < count; ++i) {
      const double first = static_cast<double>(i) / count, last = static_cast<double>(i + 1) / count;
      const double steps = length / count / spacing(point_on(h, 0.5 * (first + last)));
      pieces_.push_back({h, first, last, sum, sum + steps});
      sum += steps;
    }
  }

  void take_nearest(const Vec3d& position, BorderPoints& out) {
    near_.resize(std::min(kStandIns, count_));
    cloud_.tree.nearest(cloud_.local(position), near_);
    for (const Neighbour& neighbour : near_) {
      if (taken_[neighbour.index]) continue;
      taken_[neighbour.index] = true;
      out.stand_ins.push_back(neighbour.index);
      return;
    }
    for (; next_ < count_; ++next_) {  // all around are taken
      if (taken_[next_]) continue;
      taken_[next_] = true;
      out.stand_ins.push_back(static_cast<std::uint32_t>(next_));
      return;
    }
  }

  const TriangleMesh& mesh_;
  const std::size_t count_;
  const PointCloud cloud_;
  std::vector<Neighbour> near_;
  std::vector<bool> taken_;
  std::size_t next_ = 0;  // that may not be taken yet
  double phase_ = 0.5;    // of a step, where the first point of a border lies
  // Of the border that is looked at:
  std::vector<std::uint32_t> loop_;  // its halfedges
  std::vector<double> along_;        // its length up to each of them, and in all
  std::vector<Piece> pieces_;
};

}  // namespace

BorderPoints place_on_borders(const TriangleMesh& mesh, std::span<const Vec3d> positions, const ExecutionContext& context) {
  BorderPoints out;
  if (std::find(mesh.twins.begin(), mesh.twins.end(), kNone) == mesh.twins.end()) return out;
  BorderPlacer placer(mesh, positions);
  std::vector<bool> seen(mesh.twins.size(), false);
  for (std::uint32_t start = 0; start < mesh.twins.size() && !context.cancelled(); ++start) {
    if (mesh.twins[start] != kNone || seen[start]) continue;
    placer.place_on(start, out);
    std::uint32_t h = start;
    do {
      seen[h] = true;
      h = next_on_border(mesh.twins, h);
    } while (h != start);
  }
  std::sort(out.stand_ins.begin(), out.stand_ins.end());
  return out;
}

}  // namespace curvecast
