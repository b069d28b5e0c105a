#include "core/sample/scatter.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/for_all.h"
#include "core/base/memory_claim.h"
#include "core/base/random.h"
#include "core/curve/place_attributes.h"
#include "core/mesh/face_order.h"
#include "core/sample/move_apart.h"
#include "core/sample/resample.h"
#include "core/sample/splat_radius.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr std::uint64_t kBytesPerFace = 44, kBytesPerPoint = 80;

/// What the curve passes of each face.
struct FaceCurve {
  std::vector<std::uint32_t> order;  // F
  std::vector<double> passed;        // F + 1: the density's integral up to the i-th face of the order; ascending from 0
  std::size_t last = 0;              // of the order that has any
};

FaceCurve sum_along(const TriangleMesh& mesh, std::span<const float> density, const ExecutionContext& context) {
  FaceCurve curve{face_order(mesh, context), std::vector<double>(mesh.face_count() + 1, 0.0)};
  for_blocks(context, curve.order.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t face = curve.order[i];
      curve.passed[i + 1] = triangle_area(mesh, face) * (density.empty() ? 1.0 : static_cast<double>(density[face]));
    }
  });
  for (std::size_t i = 0; i < curve.order.size(); ++i) {
    if (curve.passed[i + 1] > 0) curve.last = i;
    curve.passed[i + 1] += curve.passed[i];
  }
  return curve;
}

/// The curve through one face.
class FaceWay {
 public:
  /// From one end of the longest side to the other: in the sense in which it comes from `before` and leads to `after`.
  FaceWay(const TriangleMesh& mesh, std::uint32_t face, const Vec3d& before, const Vec3d& after) {
    const Triangle& t = mesh.triangles[face];
    std::size_t from = 0;
    double longest = -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double length = (mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]).squaredNorm();
      if (length > longest) longest = length, from = i;
    }
    std::size_t to = (from + 1) % 3;
    const Vec3d along = mesh.positions[t[to]] - mesh.positions[t[from]];
    if (along.dot(after - before) < 0) std::swap(from, to);
    begin_ = kCorners[from], apex_ = kCorners[3 - from - to], end_ = kCorners[to];
  }

  /// Weights of the face's second and third corner, where the curve has passed a part of the face, in [0, 1); found by so many
  /// halvings.
  std::array<float, 2> at(double part, int halvings) const {
    Vec2d begin = begin_, apex = apex_, end = end_;
    for (int i = 0; i < halvings; ++i) {
      const Vec2d middle = (begin + end) / 2;
      part *= 2;
      const bool is_second = part >= 1;
      part -= is_second ? 1 : 0;
      // The halves meet in the apex: the curve goes from the begin to it, and from there to the end.
      begin = is_second ? apex : begin;
      end = is_second ? end : apex;
      apex = middle;
    }
    // What is left is passed along its middle.
    const Vec2d place = (begin + apex) / 2 + part / 2 * (end - begin);
    return {static_cast<float>(place.x()), static_cast<float>(place.y())};
  }

 private:
  static inline const std::array<Vec2d, 3> kCorners{Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1)};

  Vec2d begin_, apex_, end_;
};

Vec3d centroid(const TriangleMesh& mesh, std::uint32_t face) {
  const Triangle& t = mesh.triangles[face];
  return (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
}

/// So many halvings make parts of a face that are far smaller than what a point has.
int halvings_of(double points) {
  constexpr int kBeyond = 14, kMost = 46;  // as long as a part has digits left
  return std::min(kBeyond + std::max(0, static_cast<int>(std::ceil(std::log2(std::max(points, 1.0))))), kMost);
}

void place_points(const TriangleMesh& mesh, const FaceCurve& curve, std::uint64_t seed, PointSet& points,
                  const ExecutionContext& context) {
  const double step = curve.passed.back() / static_cast<double>(points.size());
  const double first = seed == 0 ? 0.5 : random_unit(seed, 0);
  for_blocks(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const auto passed_at = [&](std::size_t i) { return (static_cast<double>(i) + first) * step; };
    auto f = static_cast<std::size_t>(std::upper_bound(curve.passed.begin() + 1, curve.passed.end() - 1, passed_at(begin)) -
                                      curve.passed.begin() - 1);
    f = std::min(f, curve.last);
    for (std::size_t i = begin; i < end;) {
      while (f < curve.last && curve.passed[f + 1] <= passed_at(i)) ++f;
      const std::uint32_t face = curve.order[f];
      const double share = curve.passed[f + 1] - curve.passed[f];
      const FaceWay way(mesh, face, centroid(mesh, curve.order[f > 0 ? f - 1 : 0]),
                        centroid(mesh, curve.order[std::min(f + 1, curve.last)]));
      const int halvings = halvings_of(share / step);
      // All that lie in the face; at least this one, also where rounding would have it beyond the last.
      do {
        const double part = std::clamp((passed_at(i) - curve.passed[f]) / share, 0.0, 1 - 0x1p-53);
        const std::array<float, 2> weights = way.at(part, halvings);
        points.places[i] = {face, weights[0], weights[1]};
        ++i;
      } while (i < end && passed_at(i) < curve.passed[f + 1]);
    }
  });
}

/// Fills in what is at the points' places.
void describe_points(const TriangleMesh& mesh, const SurfaceData& data, std::span<const float> density, double mass,
                     PointSet& points, const ExecutionContext& context) {
  const double largest = bounding_box(mesh).diagonal();
  for_blocks(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [face, weight_1, weight_2] = points.places[i];
      const Triangle& t = mesh.triangles[face];
      const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
      const Vec3d position = a + static_cast<double>(weight_1) * (b - a) + static_cast<double>(weight_2) * (c - a);
      points.positions[i] = (position - points.origin).cast<float>();
      points.normals[i] = normal_at(data, face, {weight_1, weight_2});
      const double area = mass / (density.empty() ? 1.0 : static_cast<double>(density[face]));
      points.radii[i] = SplatRadius::of_area(area, largest);
      if (points.colours.empty()) continue;
      points.colours[i] = data.colour->at(face, {1 - weight_1 - weight_2, weight_1, weight_2}, area);
    }
  });
}

}  // namespace

absl::StatusOr<PointSet> scatter(const TriangleMesh& mesh, const SurfaceData& data, std::span<const float> density,
                                 const ScatterOptions& options, const ExecutionContext& context) {
  if (absl::Status status = check_sample(options.points, {}); !status.ok()) return status;
  MemoryClaim claim(context);
  const std::uint64_t bytes = kBytesPerFace * mesh.face_count() + kBytesPerPoint * options.points;
  const std::string what = absl::StrFormat("scattering %d points on %d triangles takes %s of memory", options.points,
                                           mesh.face_count(), describe_bytes(static_cast<double>(bytes)));
  if (absl::Status status = claim.set(bytes, what); !status.ok()) return status;
  context.progress("scatter", 0);
  const FaceCurve curve = sum_along(mesh, density, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  const double mass = curve.passed.back() / static_cast<double>(options.points);
  if (!(mass > 0 && std::isfinite(mass))) return nowhere_to_put_points();
  PointSet points;
  points.origin = bounding_box(mesh).center();
  points.positions.resize(options.points);
  points.normals.resize(options.points);
  points.radii.resize(options.points);
  points.places.resize(options.points);
  if (data.colour != nullptr) points.colours.resize(options.points);
  place_points(mesh, curve, options.seed, points, context);
  describe_points(mesh, data, density, mass, points, context);
  points.has_moved = true;
  if (absl::Status status = context.check(); !status.ok()) return status;
  if (absl::Status status = move_apart(mesh, data, options.rounds, points, context); !status.ok()) return status;
  context.progress("scatter", 1);
  return points;
}

}  // namespace curvecast
