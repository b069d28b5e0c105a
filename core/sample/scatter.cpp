#include "core/sample/scatter.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/for_all.h"
#include "core/base/memory_claim.h"
#include "core/base/origin.h"
#include "core/base/random.h"
#include "core/curve/place_attributes.h"
#include "core/sample/face_curve.h"
#include "core/sample/move_apart.h"
#include "core/sample/resample.h"
#include "core/sample/splat_radius.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "scatter";
constexpr std::size_t kGrain = 4096;
// Pieces that a density is looked at on, as long as they are not too many: it is taken for even within each.
constexpr std::uint64_t kPiecesPerPoint = 4, kMostPieces = 4'000'000;
constexpr std::uint64_t kBytesPerFace = 44, kBytesPerPiece = 90, kBytesPerPoint = 80;

/// What the curve passes.
struct Passed {
  std::vector<float> density;  // of each piece; empty: the same of all
  std::vector<double> sum;     // P + 1: the density's integral up to each piece; ascending from 0
  std::size_t last = 0;        // piece that has any

  double density_of(std::size_t piece) const { return density.empty() ? 1 : static_cast<double>(density[piece]); }
};

absl::StatusOr<std::vector<float>> look_at(const FaceCurve& curve, const DensityAt& density, const ExecutionContext& context) {
  std::vector<std::uint32_t> faces(curve.size());
  std::vector<std::array<float, 2>> weights(curve.size());
  for_blocks(context, curve.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      faces[i] = curve.face(i);
      weights[i] = curve.way(i).at(0.5, 0);
    }
  });
  if (absl::Status status = context.check(); !status.ok()) return status;
  return density(faces, weights);
}

absl::StatusOr<Passed> sum_along(const FaceCurve& curve, const DensityAt& density, const ExecutionContext& context) {
  Passed passed;
  if (density) {
    absl::StatusOr<std::vector<float>> found = look_at(curve, density, context);
    if (!found.ok()) return found.status();
    passed.density = *std::move(found);
  }
  passed.sum.resize(curve.size() + 1);
  for_blocks(context, curve.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) passed.sum[i + 1] = curve.area(i) * passed.density_of(i);
  });
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (passed.sum[i + 1] > 0) passed.last = i;
    passed.sum[i + 1] += passed.sum[i];
  }
  return passed;
}

/// So many halvings make parts of a piece that are far smaller than what a point has.
int halvings_for(double points) {
  constexpr int kBeyond = 14, kMost = 46;  // as long as a part has digits left
  return std::min(kBeyond + std::max(0, static_cast<int>(std::ceil(std::log2(std::max(points, 1.0))))), kMost);
}

/// Sets places and radii. `mass`: what the curve passes from point to point.
void place_points(const FaceCurve& curve, const Passed& passed, double mass, std::uint64_t seed, double largest_radius,
                  PointSet& points, const ExecutionContext& context) {
  const double first = seed == 0 ? 0.5 : random_unit(seed, 0);
  const auto passed_at = [&](std::size_t i) { return (static_cast<double>(i) + first) * mass; };
  for_blocks(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    const auto above = std::upper_bound(passed.sum.begin() + 1, passed.sum.end() - 1, passed_at(begin));
    auto piece = std::min(static_cast<std::size_t>(above - passed.sum.begin() - 1), passed.last);
    for (std::size_t i = begin; i < end;) {
      while (piece < passed.last && passed.sum[piece + 1] <= passed_at(i)) ++piece;
      const std::uint32_t face = curve.face(piece);
      const FaceCurve::Way way = curve.way(piece);
      const double share = passed.sum[piece + 1] - passed.sum[piece];
      const int halvings = halvings_for(share / mass);
      // All that lie in the piece; at least this one, also where rounding would have it beyond the last.
      do {
        const double part = std::clamp((passed_at(i) - passed.sum[piece]) / share, 0.0, 1 - 0x1p-53);
        const std::array<float, 2> weights = way.at(part, halvings);
        points.places[i] = {face, weights[0], weights[1]};
        points.radii[i] = SplatRadius::of_area(mass / passed.density_of(piece), largest_radius);
        ++i;
      } while (i < end && passed_at(i) < passed.sum[piece + 1]);
    }
  });
}

/// Fills in what is at the points' places.
void describe_points(const TriangleMesh& mesh, const SurfaceData& data, PointSet& points, const ExecutionContext& context) {
  for_blocks(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [face, weight_1, weight_2] = points.places[i];
      const Triangle& t = mesh.triangles[face];
      const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
      const Vec3d position = a + static_cast<double>(weight_1) * (b - a) + static_cast<double>(weight_2) * (c - a);
      points.positions[i] = (position - points.origin).cast<float>();
      points.normals[i] = normal_at(data, face, {weight_1, weight_2});
      if (points.colours.empty()) continue;
      const double area = SplatRadius::area_of_point(points.radii[i]);
      points.colours[i] = data.colour->at(face, {1 - weight_1 - weight_2, weight_1, weight_2}, area);
    }
  });
}

}  // namespace

absl::StatusOr<PointSet> scatter(const TriangleMesh& mesh, const SurfaceData& data, const DensityAt& density,
                                 const ScatterOptions& options, const ExecutionContext& context) {
  if (absl::Status status = check_sample(options.points, {}); !status.ok()) return status;
  const std::uint64_t pieces = density ? std::min(kPiecesPerPoint * options.points, kMostPieces) : 0;
  MemoryClaim claim(context);
  const std::uint64_t bytes =
      kBytesPerFace * mesh.face_count() + kBytesPerPiece * (mesh.face_count() + 2 * pieces) + kBytesPerPoint * options.points;
  const std::string what = absl::StrFormat("scattering %d points on %d triangles takes %s of memory", options.points,
                                           mesh.face_count(), describe_bytes(static_cast<double>(bytes)));
  if (absl::Status status = claim.set(bytes, what); !status.ok()) return status;
  context.progress(kStage, 0);
  const double largest =
      pieces > 0 ? surface_area(mesh, context) / static_cast<double>(pieces) : std::numeric_limits<double>::infinity();
  const FaceCurve curve(mesh, largest, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  const absl::StatusOr<Passed> passed = sum_along(curve, density, context);
  if (!passed.ok()) return passed.status();
  if (absl::Status status = context.check(); !status.ok()) return status;
  const double mass = passed->sum.back() / static_cast<double>(options.points);
  if (!(mass > 0 && std::isfinite(mass))) return nowhere_to_put_points();
  const Box3d box = bounding_box(mesh);
  PointSet points;
  points.origin = choose_origin(box);
  points.positions.resize(options.points);
  points.normals.resize(options.points);
  points.radii.resize(options.points);
  points.places.resize(options.points);
  if (data.colour != nullptr) points.colours.resize(options.points);
  place_points(curve, *passed, mass, options.seed, box.diagonal(), points, context);
  describe_points(mesh, data, points, context);
  points.has_moved = true;
  if (absl::Status status = context.check(); !status.ok()) return status;
  context.progress(kStage, 1);
  if (absl::Status status = move_apart(mesh, data, options.rounds, points, context); !status.ok()) return status;
  return points;
}

}  // namespace curvecast
