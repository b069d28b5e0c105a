// Points straight on a mesh with all that is known at their places, for one set of them: see scatter().
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/execution_context.h"
#include "core/density/density.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/point_set.h"

namespace curvecast {

struct MeshScatter {
  Density density;                       // none = uniform; its global distance terms leave fewer points
  std::uint64_t points = 50'000;         // N, 1 .. kMaxPoints
  std::uint64_t seed = 0;                // see ScatterOptions
  int rounds = 0;                        // of move_apart()
  std::optional<double> crease_degrees;  // as PreprocessOptions has it
  // What is wanted of each point besides position, normal, radius, colour and place.
  bool curvatures = false, directions = false, scalars = false;
  bool ranks = false;  // see nested_order()
};

struct ScatteredPoints {
  PointSet points;                // of whose places the faces are polygons of the file
  std::vector<float> curvatures;  // 2 N, 1/unit; directions: 3 N; both where they were asked for, else empty
  std::vector<float> directions;
  std::vector<std::pair<std::string, std::vector<float>>> scalars;  // N each, under their names
};

/// Scatters points on a mesh that was repaired. The same for any number of threads. InvalidArgument: crease_degrees, a density
/// that needs what the mesh has not; errors of scatter() and nested_order(); Cancelled.
absl::StatusOr<ScatteredPoints> scatter_mesh(const LoadedMesh& mesh, const MeshScatter& wanted,
                                             const ExecutionContext& context = {});

}  // namespace curvecast
