// From a mesh to parameterised discs: cuts, maps, checks, and falls back until every disc is valid.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/disc_mesh.h"
#include "core/flatten/extremities.h"

namespace curvecast {

/// How a chart was mapped to the square, in the order in which they are tried.
enum class Parameterisation {
  kLeastStretch,  // minimise_stretch
  kCgal,          // parameterise_cgal, where that is asked for: instead of the least stretch
  kMeanValue,     // parameterise with mean value weights
  kUniform,       // parameterise with uniform weights, the most robust
};

/// A disc with its place in the parameter square. No triangle is flipped or empty.
struct Chart {
  DiscMesh disc;
  std::vector<Vec2d> uv;  // per vertex, in [0, 1]^2
  Parameterisation parameterisation = Parameterisation::kLeastStretch;
};

enum class Parameteriser {
  kLeastStretch,  // minimise_stretch()
  kCgal,          // parameterise_cgal(): slower, more distortion; for comparison
};

struct FlattenOptions {
  ExtremityOptions extremities;
  Parameteriser parameteriser = Parameteriser::kLeastStretch;
  /// A chart is divided when some triangle's surface-to-uv area ratio exceeds its mean by this factor: the quadtree would go too
  /// deep for the curve's keys.
  double max_area_ratio = 1e9;
  /// A component of more faces than this is divided into charts of about `chart_faces`, by partition_faces().
  std::size_t most_whole_faces = 1'000'000, chart_faces = 100'000;
};

/// What flatten() takes of components: each is a chart at least, with memory of its own.
inline constexpr std::size_t kMostComponents = 1'000'000;

struct FlattenTimes {  // seconds
  double cut = 0, parameterise = 0;
};

/// One chart per component, or several where it is large; or where one defeats every parameterisation in turn and is divided into
/// halves until it doesn't: down to single triangles, which always succeed. Every face of the mesh lies in exactly one chart,
/// whole. Charts come in the order of their components, and in one component each, as a rule, is a neighbour of the one before,
/// with the square's corner (0, 0) beside that one's corner (1, 0): the Hilbert curve goes on where it ended. Charts are made
/// side by side on all threads. InvalidArgument where there are more than kMostComponents; Cancelled when the context says so
/// (CGAL's solver ends first).
absl::StatusOr<std::vector<Chart>> flatten(const TriangleMesh& mesh, const FlattenOptions& options,
                                           const ExecutionContext& context, FlattenTimes& times);

}  // namespace curvecast
