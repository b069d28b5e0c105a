#include "core/remesh/line_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/measure/point_cloud.h"

namespace curvecast {
namespace {

constexpr std::size_t kLeastOnLoop = 3;
constexpr std::size_t kNear = 8;                       // points that tell how dense they are
constexpr std::size_t kStandIns = 32;                  // nearest points of which one is taken
constexpr double kMostPieces = 1000;                   // of an edge
constexpr double kCornerCosine = 0.70710678118654752;  // of 45 degrees
constexpr double kReach = 0.75;                        // of the distance to the next point: how far a corner sees along its line
constexpr double kGolden = 0.61803398874989485;

class LinePlacer {
 public:
  LinePlacer(const TriangleMesh& mesh, std::span<const SurfaceLine> lines, std::span<const Vec3d> positions)
      : mesh_(mesh),
        count_(positions.size()),
        cloud_(positions, bounding_box(mesh)),
        taken_(positions.size(), false),
        stays_(mesh.vertex_count(), false),
        is_corner_(mesh.vertex_count(), false) {
    // Borders come first, and turn at the ends of features.
    for (const SurfaceLine& line : lines) {
      if (line.is_closed) continue;
      stays_[mesh.from(line.halfedges.front())] = stays_[mesh.to(line.halfedges.back())] = true;
    }
  }

  /// Returns whether the line is long enough for points.
  bool place_on(const SurfaceLine& line, LinePoints& out) {
    list_line(line);
    if (line.has_loose_end && steps_along() < 1) return false;
    const std::vector<std::size_t> corners = find_corners();
    for (const std::size_t corner : corners) {
      const std::uint32_t v = vertex(corner);
      if (is_corner_[v]) continue;
      is_corner_[v] = true;
      out.corners.push_back(v);
      take_nearest(mesh_.positions[v], out);
    }
    if (corners.empty()) {
      place_between(0, edges(), kLeastOnLoop, false, out);
    } else if (line.is_closed) {
      const std::size_t least = corners.size() < kLeastOnLoop ? kLeastOnLoop - 1 : 0;
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const std::size_t next = c + 1 < corners.size() ? corners[c + 1] : corners[0] + edges();
        place_between(corners[c], next, least, true, out);
      }
    } else {
      const bool comes_back = corners.size() == 2 && vertex(0) == vertex(edges());
      const std::size_t least = comes_back ? kLeastOnLoop - 1 : 0;
      for (std::size_t c = 0; c + 1 < corners.size(); ++c) place_between(corners[c], corners[c + 1], least, true, out);
    }
    // Borders may lie on one another, where repair has opened an edge of many faces: their points must not.
    phase_ += kGolden - (phase_ + kGolden >= 1 ? 1 : 0);
    return true;
  }

 private:
  /// A part of an edge, from `first` to `last` of its length, and where it lies along the line in steps from point to point.
  struct Piece {
    std::uint32_t halfedge;
    double first, last, begin, end;
  };

  Vec3d point_on(std::uint32_t h, double part) const {
    const Vec3d& a = mesh_.positions[mesh_.from(h)];
    return a + part * (mesh_.positions[mesh_.to(h)] - a);
  }

  std::size_t edges() const { return halfedges_.size(); }
  /// The line's vertices: as many as edges, and the last one's end where it is open.
  std::size_t vertices() const { return edges() + (is_closed_ ? 0 : 1); }
  std::uint32_t vertex(std::size_t i) const { return i < edges() ? mesh_.from(halfedges_[i]) : mesh_.to(halfedges_.back()); }

  /// The distance of neighbours in a hexagonal lattice as dense as the points here, which lie on one side of a border only.
  double spacing(const Vec3d& position) {
    near_.resize(std::min(kNear, count_));
    cloud_.tree.nearest(cloud_.local(position), near_);
    const double r = cloud_.distance(near_.back());
    const double area = (is_border_ ? 0.5 : 1) * std::numbers::pi * r * r / (static_cast<double>(near_.size()) - 0.5);
    return std::sqrt(2 / std::numbers::sqrt3 * area);
  }

  void list_line(const SurfaceLine& line) {
    halfedges_ = line.halfedges;
    is_closed_ = line.is_closed;
    is_border_ = line.is_border;
    along_.assign(1, 0.0);
    for (const std::uint32_t h : halfedges_) along_.push_back(along_.back() + (point_on(h, 1) - point_on(h, 0)).norm());
  }

  /// The line's length, in distances of points beside it.
  double steps_along() {
    double steps = 0;
    for (std::size_t i = 0; i < edges(); ++i) steps += (along_[i + 1] - along_[i]) / spacing(point_on(halfedges_[i], 0.5));
    return steps;
  }

  /// The place on the line so far along it; below zero or beyond its length on the next turn, or at the end.
  Vec3d point_along(double at) const {
    if (is_closed_) {
      at -= std::floor(at / along_.back()) * along_.back();
    } else {
      at = std::clamp(at, 0.0, along_.back());
    }
    const auto edge = static_cast<std::size_t>(std::upper_bound(along_.begin() + 1, along_.end() - 1, at) - along_.begin() - 1);
    const double length = along_[edge + 1] - along_[edge];
    return point_on(halfedges_[edge], length > 0 ? std::clamp((at - along_[edge]) / length, 0.0, 1.0) : 0);
  }

  /// The vertices of the line at which it turns enough, and the most as far as they see; and those at which others end.
  std::vector<std::size_t> find_corners() {
    const std::size_t n = vertices();
    std::vector<double> cosine(n), reach(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d& at = mesh_.positions[vertex(i)];
      reach[i] = std::min(kReach * spacing(at), along_.back() / 4);
      const Vec3d before = at - point_along(along_[i] - reach[i]), after = point_along(along_[i] + reach[i]) - at;
      const double lengths = before.norm() * after.norm();
      cosine[i] = stays_[vertex(i)] ? -2 : lengths > 0 ? before.dot(after) / lengths : 1;
    }
    const auto is_sharpest = [&](std::size_t i, bool forward) {  // one way round
      double way = 0;
      for (std::size_t k = i, count = 1; count < n; ++count) {
        if (!is_closed_ && k == (forward ? n - 1 : 0)) break;
        const std::size_t next = (k + (forward ? 1 : n - 1)) % n, edge = forward ? k : next;
        way += along_[edge + 1] - along_[edge];
        if (way > reach[i]) break;
        if (cosine[next] < cosine[i] || (cosine[next] == cosine[i] && next < i)) return false;
        k = next;
      }
      return true;
    };
    std::vector<std::size_t> corners;
    for (std::size_t i = 0; i < n; ++i) {
      const bool turns = cosine[i] < kCornerCosine && is_sharpest(i, true) && is_sharpest(i, false);
      if (turns || stays_[vertex(i)]) corners.push_back(i);
    }
    return corners;
  }

  /// Places points on edges [first, last) of the line, counted on beyond its end, so many at least. `between_ends`: both ends are
  /// points themselves.
  void place_between(std::size_t first, std::size_t last, std::size_t least, bool between_ends, LinePoints& out) {
    pieces_.clear();
    double sum = 0;
    for (std::size_t i = first; i < last; ++i) add_pieces(halfedges_[i % edges()], sum);
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
      out.places.push_back({on.halfedge, part});
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

  void take_nearest(const Vec3d& position, LinePoints& out) {
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
  std::size_t next_ = 0;         // that may not be taken yet
  std::vector<bool> stays_;      // per vertex of the mesh: an open line ends there
  std::vector<bool> is_corner_;  // per vertex of the mesh: it is among the corners
  double phase_ = 0.5;           // of a step, where the first point of a closed line lies
  // Of the line that is looked at:
  std::vector<std::uint32_t> halfedges_;
  bool is_closed_ = false, is_border_ = false;
  std::vector<double> along_;  // its length up to each of its halfedges, and in all
  std::vector<Piece> pieces_;
};

}  // namespace

LinePoints place_on_lines(const TriangleMesh& mesh, std::span<const SurfaceLine> lines, std::span<const Vec3d> positions,
                          const ExecutionContext& context) {
  LinePoints out;
  if (lines.empty()) return out;
  LinePlacer placer(mesh, lines, positions);
  for (const SurfaceLine& line : lines) {
    if (context.cancelled()) break;
    out.used.push_back(placer.place_on(line, out));
  }
  std::sort(out.stand_ins.begin(), out.stand_ins.end());
  return out;
}

}  // namespace curvecast
