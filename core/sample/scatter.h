// Points straight on a mesh, without charts: for one set of points, where cutting and flattening the mesh would take most of the
// time. What a curve over the faces passes is summed up and inverted, as by equalisation (paper, section 3.4).
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/curve/surface_map.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sample/point_set.h"

namespace curvecast {

struct ScatterOptions {
  std::uint64_t points = 50'000;  // N, 1 .. kMaxPoints
  std::uint64_t seed = 0;         // moves all points along the curve, by less than one takes of it
  int rounds = 0;                 // of move_apart()
};

/// Returns the density at places on faces, by the weights of their second and third corners, relative to others': at least 0,
/// finite.
using DensityAt = std::function<absl::StatusOr<std::vector<float>>(std::span<const std::uint32_t> faces,
                                                                   std::span<const std::array<float, 2>> weights)>;

/// Makes exactly options.points points on the mesh that `data` is of, in the order of a FaceCurve, each with its place; none has
/// a curve vertex. `density`: asked once, at a few places for each point and at one at least on each face; empty: the same
/// everywhere. The same for any number of threads of the arena. Errors: InvalidArgument, OutOfRange: N; FailedPrecondition: the
/// density is zero everywhere; those of `density`, of MemoryClaim and of move_apart(); Cancelled.
absl::StatusOr<PointSet> scatter(const TriangleMesh& mesh, const SurfaceData& data, const DensityAt& density,
                                 const ScatterOptions& options, const ExecutionContext& context = {});

}  // namespace curvecast
