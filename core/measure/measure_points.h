// Takes all measures of point sets on a mesh (paper, section 4.2).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/density/density.h"
#include "core/measure/discrepancy.h"
#include "core/measure/spacing.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct MeasureOptions {
  int ring_seeds = 256;                      // of the ring discrepancy, 1 .. kMaxRegions
  int ball_centres = 1024;                   // of the ball discrepancy, four balls about each, 1 .. kMaxRegions
  std::uint64_t seed = 0;                    // of both choices
  Density density;                           // that the points are to have: its mean over each face counts; none = uniform
  std::span<const ScalarAttribute> scalars;  // of the mesh, for a density that uses them
};
inline constexpr int kMaxRegions = 100'000;
/// Limits how far points may lie from the mesh, in diagonals of its box: what is farther out was made for another mesh.
inline constexpr double kMaxReach = 1e6;

struct PointMeasures {
  std::uint64_t points = 0;
  double surface_max = 0, surface_mean = 0;  // distance of the points to the surface, in the mesh's units
  Discrepancy ring, ball;
  NeighbourDistances spacing, spacing_on_side;  // on_side: with the normals of the faces nearest to the points
  double coverage = 0;                          // coverage_radius() over packing_radius()
};

/// Powers of N by which discrepancies fall.
struct MeasureGradients {
  double ring_max = 0, ring_rms = 0, ball_max = 0, ball_rms = 0;
};

struct MeasureReport {
  std::vector<PointMeasures> sets;
  std::optional<MeasureGradients> gradient;  // where sets differ in size, and no discrepancy is 0
};

/// Measures sets of points, in absolute coordinates, that may come from anywhere: in any order, and on the surface or near it.
/// Their spacing is that of even sets also where there is a density. The same for any number of threads. InvalidArgument: no set,
/// or one of less than two points or with one that is not finite or farther than kMaxReach from the mesh; options out of range; a
/// bad term. FailedPrecondition: the density is zero everywhere. Cancelled. Precondition: the mesh has an area.
absl::StatusOr<MeasureReport> measure_points(const TriangleMesh& mesh, std::span<const std::vector<Vec3d>> sets,
                                             const MeasureOptions& options, const ExecutionContext& context = {});

}  // namespace curvecast
