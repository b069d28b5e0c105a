#include "core/measure/hausdorff.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/for_all.h"
#include "core/measure/picture_scale.h"
#include "core/measure/triangle_tree.h"
#include "core/mesh/triangle_distance.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "hausdorff";
constexpr std::size_t kBatch = 1 << 14;    // triangles looked at in one go
constexpr std::size_t kSamples = 1 << 17;  // places looked up in one go
constexpr std::size_t kGrain = 256;

/// A place of one surface and the nearest of the other.
struct Place {
  Vec3d position, foot;
  double distance;
  std::uint32_t face;  // on which the foot lies
};

/// A part of a face, by its corners.
using Part = std::array<Place, 3>;

/// Returns how far the segment from p to q passes by the segment from a to b at most: the distance between a point of each.
double gap(const Vec3d& p, const Vec3d& q, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = q - p, e = b - a, r = p - a;
  const double dd = d.squaredNorm(), ee = e.squaredNorm(), de = d.dot(e), determinant = dd * ee - de * de;
  double s = determinant > 1e-12 * dd * ee ? std::clamp((de * e.dot(r) - ee * d.dot(r)) / determinant, 0.0, 1.0) : 0.5;
  const double t = ee > 0 ? std::clamp((e.dot(r) + s * de) / ee, 0.0, 1.0) : 0.0;
  s = dd > 0 ? std::clamp((t * de - d.dot(r)) / dd, 0.0, 1.0) : 0.0;
  return (r + s * d - t * e).norm();
}

/// Measures the distance of one surface from another.
class OneWay {
 public:
  OneWay(const TriangleMesh& from, const TriangleMesh& to, const PictureScale& scale, const ExecutionContext& context)
      : from_(from), to_(to), scale_(scale), tree_(to), context_(context) {
    Box3d box = bounding_box(from);
    for (const Vec3d& p : to.positions) box.extend(p);
    floor_ = kHausdorffFloor * box.diagonal();
  }

  SurfaceDistance run(std::uint64_t samples) {
    sum_up(samples);
    find_largest();
    return out_;
  }

 private:
  void see(const Vec3d& position, double distance) {
    if (!(distance > out_.max)) return;
    out_.max = distance;
    out_.farthest = position;
  }

  static std::array<Vec3d, 3> corners(const TriangleMesh& mesh, std::uint32_t f) {
    const Triangle& t = mesh.triangles[f];
    return {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  }

  /// Means, over the middles of k^2 equal parts of every face.
  void sum_up(std::uint64_t samples) {
    struct Sample {
      std::uint32_t face;
      double area;  // that it stands for
    };
    const double area = surface_area(from_, context_);
    std::vector<Sample> some;
    std::vector<Vec3d> positions;
    std::vector<NearestFace> nearest;
    std::vector<double> angles, pixels;
    double sum = 0, squares = 0, angle_sum = 0, angle_squares = 0, total = 0;
    double pixel_sum = 0, pixel_squares = 0, seen = 0;
    const auto add_some = [&] {
      nearest.resize(some.size());
      angles.resize(some.size());
      pixels.resize(some.size());
      tree_.nearest(positions, nearest);
      for_blocks(context_, some.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Vec3d here = area_vector(from_, some[i].face), there = area_vector(to_, nearest[i].face);
          pixels[i] = scale_.pixels(positions[i]);
          angles[i] = std::atan2(here.cross(there).norm(), here.dot(there)) * (180 / std::numbers::pi);
        }
      });
      for (std::size_t i = 0; i < some.size(); ++i) {
        const double d = nearest[i].distance, weight = some[i].area;
        sum += weight * d;
        squares += weight * d * d;
        angle_sum += weight * angles[i];
        angle_squares += weight * angles[i] * angles[i];
        total += weight;
        see(positions[i], d);
        if (pixels[i] == 0) continue;
        const double error = pixels[i] * d;
        pixel_sum += weight * error;
        pixel_squares += weight * error * error;
        seen += weight;
        out_.picture_max = std::max(out_.picture_max, error);
      }
      some.clear();
      positions.clear();
    };
    for (std::uint32_t f = 0; f < from_.face_count() && !context_.cancelled(); ++f) {
      const auto [a, b, c] = corners(from_, f);
      const double face_area = triangle_area(from_, f);
      const double wanted = std::sqrt(static_cast<double>(samples) * face_area / area);
      const int k = static_cast<int>(std::clamp(std::ceil(wanted), 1.0, 1000.0));
      const Vec3d along = (b - a) / k, up = (c - a) / k;
      for (int j = 0; j < k; ++j) {
        for (int i = 0; i < 2 * (k - j) - 1; ++i) {  // upright and upside down in turns
          const double part = i % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
          const int column = i / 2;
          positions.emplace_back(a + (column + part) * along + (j + part) * up);
          some.push_back({f, face_area / (static_cast<double>(k) * k)});
        }
      }
      if (some.size() < kSamples) continue;
      context_.progress(kStage, static_cast<double>(f) / static_cast<double>(from_.face_count()));
      add_some();
    }
    add_some();
    out_.mean = sum / total;
    out_.rms = std::sqrt(squares / total);
    out_.normal_mean = angle_sum / total;
    out_.normal_rms = std::sqrt(angle_squares / total);
    if (!(seen > 0)) return;
    out_.picture_mean = pixel_sum / seen;
    out_.picture_rms = std::sqrt(pixel_squares / seen);
    out_.picture_share = seen / total;
  }

  Place place_at(const Vec3d& position, const NearestFace& nearest) const {
    const auto [a, b, c] = corners(to_, nearest.face);
    const Vec3d foot = nearest_on_triangle(position, a, b, c);
    return {position, foot, (position - foot).norm(), nearest.face};
  }

  /// Returns a bound of the distances over a part; infinite where none is known without looking closer.
  ///
  /// Where all feet lie on one face, each point of the part is as near to the point between them. Where they lie on two faces
  /// with a common edge, a path over a point of the edge leads from each foot on one of them to that on the other: what lies
  /// between the feet is no farther from these faces than the paths leave the straight lines.
  double bound_by_feet(const Part& part) const {
    const double most = std::max({part[0].distance, part[1].distance, part[2].distance});
    for (int i = 0; i < 3; ++i) {
      const Place &alone = part[i], &p = part[(i + 1) % 3], &q = part[(i + 2) % 3];
      if (p.face != q.face) continue;
      if (alone.face == p.face) return most;
      for (std::uint32_t h = 3 * p.face; h < 3 * p.face + 3; ++h) {
        if (to_.twins[h] == kNone || to_.twins[h] / 3 != alone.face) continue;
        const Vec3d &a = to_.positions[to_.from(h)], &b = to_.positions[to_.to(h)];
        return most + std::max(gap(p.foot, alone.foot, a, b), gap(q.foot, alone.foot, a, b));
      }
    }
    return std::numeric_limits<double>::infinity();
  }

  /// The same, by looking at the middle: whose nearest face may be near enough to all of the part.
  double bound_by_middle(const Part& part, const NearestFace& middle, const Vec3d& position) const {
    const auto [a, b, c] = corners(to_, middle.face);
    double face = 0, reach = 0;
    for (const Place& corner : part) {
      face = std::max(face, triangle_distance(corner.position, a, b, c));
      reach = std::max(reach, (corner.position - position).norm());
    }
    return std::min(face, middle.distance + reach);
  }

  void find_largest() {
    std::vector<NearestFace> nearest(from_.vertex_count());
    for_blocks_in_turn(context_, nearest.size(), kSamples, [&](std::size_t begin, std::size_t end) {
      tree_.nearest(std::span(from_.positions).subspan(begin, end - begin), std::span(nearest).subspan(begin, end - begin));
    });
    if (context_.cancelled()) return;
    for (const Triangle& t : from_.triangles) {
      for (const std::uint32_t v : t) see(from_.positions[v], nearest[v].distance);
    }
    // Batches come from the end of what is left: deep first, so that there is never much of it, and in an order of their own, so
    // that threads don't matter.
    std::vector<Part> left, batch;
    for (std::uint32_t next = 0; (next < from_.face_count() || !left.empty()) && !context_.cancelled();) {
      const std::size_t taken = std::min(kBatch, left.size());
      batch.assign(left.end() - static_cast<std::ptrdiff_t>(taken), left.end());
      left.resize(left.size() - taken);
      for (; batch.size() < kBatch && next < from_.face_count(); ++next) {
        Part part;
        for (int i = 0; i < 3; ++i) {
          const std::uint32_t v = from_.triangles[next][i];
          part[i] = place_at(from_.positions[v], nearest[v]);
        }
        batch.push_back(part);
      }
      halve_open(batch, left);
    }
  }

  double enough() const { return std::max(out_.max * (1 + kHausdorffTolerance), floor_); }

  /// Adds the halves of all parts that may hold the largest distance to `left`.
  void halve_open(std::vector<Part>& batch, std::vector<Part>& left) {
    std::erase_if(batch, [&](const Part& part) { return bound_by_feet(part) <= enough(); });
    std::vector<NearestFace> middle(batch.size());
    std::vector<std::uint8_t> open(batch.size());
    std::vector<Vec3d> centre(batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
      centre[i] = (batch[i][0].position + batch[i][1].position + batch[i][2].position) / 3;
    }
    tree_.nearest(centre, middle);
    for (std::size_t i = 0; i < batch.size(); ++i) see(centre[i], middle[i].distance);
    std::vector<std::array<Part, 2>> halves(batch.size());
    for_blocks(context_, batch.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        open[i] = bound_by_middle(batch[i], middle[i], centre[i]) > enough();
        if (open[i] != 0) halves[i] = halve(batch[i]);
      }
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (open[i] == 0) continue;
      see(halves[i][0][1].position, halves[i][0][1].distance);
      left.insert(left.end(), halves[i].begin(), halves[i].end());
    }
  }

  /// Both halves, cut through the longest side; its middle is corner 1 of the first.
  std::array<Part, 2> halve(const Part& part) const {
    int longest = 0;
    double square = -1;
    for (int i = 0; i < 3; ++i) {
      const double side = (part[(i + 1) % 3].position - part[i].position).squaredNorm();
      if (side > square) longest = i, square = side;
    }
    const Place &a = part[longest], &b = part[(longest + 1) % 3], &c = part[(longest + 2) % 3];
    const Vec3d middle = 0.5 * (a.position + b.position);
    const Place place = place_at(middle, tree_.nearest(middle));
    return {Part{a, place, c}, Part{place, b, c}};
  }

  const TriangleMesh &from_, &to_;
  const PictureScale& scale_;
  const TriangleTree tree_;
  const ExecutionContext& context_;
  double floor_ = 0;
  SurfaceDistance out_;
};

}  // namespace

HausdorffDistance hausdorff_distance(const TriangleMesh& first, const TriangleMesh& second, const HausdorffOptions& options,
                                     const ExecutionContext& context) {
  const PictureScale scale(options.cameras);
  HausdorffDistance out;
  out.forward = OneWay(first, second, scale, context).run(options.samples);
  out.backward = OneWay(second, first, scale, context).run(options.samples);
  return out;
}

}  // namespace curvecast
