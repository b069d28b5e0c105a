// Points straight on a mesh, without charts: for one set of points, where cutting and flattening the mesh would take most of the
// time. The curve goes over the faces as they follow one another in space, and through each of them by halves; what it passes is
// summed up and inverted, as by equalisation (paper, section 3.4).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>

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

/// Makes exactly options.points points on the mesh that `data` is of, in the order of the curve, each with its place; none has a
/// curve vertex. `density` (F entries, at least 0, finite): of each face, relative to others'; empty: all the same. The same for
/// any number of threads of the arena. Errors: InvalidArgument, OutOfRange: N; FailedPrecondition: the density is zero
/// everywhere; those of move_apart(). Source of the curve in a face: Sierpinski, "Sur une nouvelle courbe continue qui remplit
/// toute une aire plane" (1912), on triangles that are halved through their longest sides first.
absl::StatusOr<PointSet> scatter(const TriangleMesh& mesh, const SurfaceData& data, std::span<const float> density,
                                 const ScatterOptions& options, const ExecutionContext& context = {});

}  // namespace curvecast
