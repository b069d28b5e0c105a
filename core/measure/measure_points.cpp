#include "core/measure/measure_points.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

#include "core/base/with_threads.h"
#include "core/density/face_density.h"
#include "core/measure/ball_discrepancy.h"
#include "core/measure/coverage.h"
#include "core/measure/gradient.h"
#include "core/measure/ring_discrepancy.h"
#include "core/measure/triangle_tree.h"
#include "core/mesh/curvature.h"

namespace curvecast {
namespace {

using Faces = std::vector<std::vector<std::uint32_t>>;  // of each set's points

absl::Status check_count(const char* name, int count) {
  if (count >= 1 && count <= kMaxRegions) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat("%s = %d; it must lie in 1 .. %d", name, count, kMaxRegions));
}

absl::Status check_set(const std::vector<Vec3d>& points, std::size_t set, const Box3d& box) {
  if (points.size() < 2) {
    return absl::InvalidArgumentError(
        absl::StrFormat("set %d has too few points, %d; at least 2 can be measured", set, points.size()));
  }
  const double reach = kMaxReach * box.diagonal();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) return absl::InvalidArgumentError(absl::StrFormat("point %d of set %d is not finite", i, set));
    if ((points[i] - box.center()).cwiseAbs().maxCoeff() <= reach) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("point %d of set %d is farther from the mesh than %g times its size; were they made for the same mesh?",
                        i, set, kMaxReach));
  }
  return absl::OkStatus();
}

absl::Status check(const Box3d& box, std::span<const std::vector<Vec3d>> sets, const MeasureOptions& options) {
  if (absl::Status status = check_count("ring_seeds", options.ring_seeds); !status.ok()) return status;
  if (absl::Status status = check_count("ball_centres", options.ball_centres); !status.ok()) return status;
  if (sets.empty()) return absl::InvalidArgumentError("there is no set of points to measure");
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (absl::Status status = check_set(sets[s], s, box); !status.ok()) return status;
  }
  return absl::OkStatus();
}

/// Of each face; empty = uniform.
absl::StatusOr<std::vector<double>> density_of(const TriangleMesh& mesh, const MeasureOptions& options,
                                               const ExecutionContext& context) {
  if (options.density.terms.empty()) return std::vector<double>{};
  return face_demand(mesh, differential_geometry(mesh), options.scalars, options.density, 1, kManyPlaces, context);
}

/// All but what depends on regions.
PointMeasures measure_set(const TriangleMesh& mesh, const TriangleTree& triangles, double area, const std::vector<Vec3d>& points,
                          std::vector<std::uint32_t>& faces, const ExecutionContext& context) {
  PointMeasures measures{.points = points.size()};
  std::vector<NearestFace> nearest(points.size());
  triangles.nearest(points, nearest);
  std::vector<Vec3f> normals;
  for (const auto& [face, distance] : nearest) {
    faces.push_back(face);
    normals.push_back(face_normal(mesh, face));
    measures.surface_max = std::max(measures.surface_max, distance);
    measures.surface_mean += distance / static_cast<double>(points.size());
  }
  const PointCloud tree(points, bounding_box(mesh));
  measures.spacing = neighbour_distances(area, tree);
  measures.spacing_on_side = neighbour_distances_on_side(area, tree, normals);
  measures.coverage = coverage_radius(mesh, tree, context) / packing_radius(area, points.size());
  return measures;
}

/// Sets are measured several at a time, as many as their counts on all faces leave in reach.
void measure_rings(const TriangleMesh& mesh, const Faces& faces, const RingDiscrepancyOptions& options,
                   const ExecutionContext& context, std::vector<PointMeasures>& sets) {
  constexpr std::size_t kMostCounts = std::size_t{1} << 26;
  const std::size_t batch = std::max<std::size_t>(1, kMostCounts / mesh.face_count());
  for (std::size_t begin = 0; begin < faces.size() && !context.cancelled(); begin += batch) {
    context.progress("rings", static_cast<double>(begin) / static_cast<double>(faces.size()));
    const std::size_t count = std::min(batch, faces.size() - begin);
    const std::vector<Discrepancy> found = ring_discrepancy(mesh, std::span(faces).subspan(begin, count), options, context);
    for (std::size_t s = 0; s < count; ++s) sets[begin + s].ring = found[s];
  }
}

std::optional<MeasureGradients> gradients_of(const std::vector<PointMeasures>& sets) {
  const auto smallest = [](const PointMeasures& m) { return std::min({m.ring.max, m.ring.rms, m.ball.max, m.ball.rms}); };
  const bool differ = std::any_of(sets.begin(), sets.end(), [&](const PointMeasures& m) { return m.points != sets[0].points; });
  if (!differ || std::any_of(sets.begin(), sets.end(), [&](const PointMeasures& m) { return !(smallest(m) > 0); })) return {};
  std::vector<double> n;
  for (const PointMeasures& m : sets) n.push_back(static_cast<double>(m.points));
  const auto gradient = [&](Discrepancy PointMeasures::*kind, double Discrepancy::*value) {
    std::vector<double> values;
    for (const PointMeasures& m : sets) values.push_back(m.*kind.*value);
    return log_log_gradient(n, values);
  };
  return MeasureGradients{gradient(&PointMeasures::ring, &Discrepancy::max), gradient(&PointMeasures::ring, &Discrepancy::rms),
                          gradient(&PointMeasures::ball, &Discrepancy::max), gradient(&PointMeasures::ball, &Discrepancy::rms)};
}

absl::StatusOr<MeasureReport> measure_here(const TriangleMesh& mesh, std::span<const std::vector<Vec3d>> sets,
                                           const MeasureOptions& options, const ExecutionContext& context) {
  if (absl::Status status = check(bounding_box(mesh), sets, options); !status.ok()) return status;
  const absl::StatusOr<std::vector<double>> density = density_of(mesh, options, context);
  if (!density.ok()) return density.status();
  context.progress("balls", 0);
  const BallDiscrepancy balls(mesh, {.centres = options.ball_centres, .seed = options.seed}, *density, context);
  const TriangleTree triangles(mesh);
  const double area = surface_area(mesh);
  MeasureReport report;
  Faces faces(sets.size());
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    context.progress("points", static_cast<double>(s) / static_cast<double>(sets.size()));
    report.sets.push_back(measure_set(mesh, triangles, area, sets[s], faces[s], context));
    report.sets.back().ball = balls.of(sets[s]);
  }
  measure_rings(mesh, faces, {.regions = options.ring_seeds, .seed = options.seed, .face_density = *density}, context,
                report.sets);
  if (absl::Status status = context.check(); !status.ok()) return status;
  report.gradient = gradients_of(report.sets);
  return report;
}

}  // namespace

absl::StatusOr<MeasureReport> measure_points(const TriangleMesh& mesh, std::span<const std::vector<Vec3d>> sets,
                                             const MeasureOptions& options, const ExecutionContext& context) {
  return with_threads(context, [&] { return measure_here(mesh, sets, options, context); });
}

}  // namespace curvecast
