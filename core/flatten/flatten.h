// From a mesh to parameterised discs: cuts, maps, checks, and falls back until every disc is valid.
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "core/execution_context.h"
#include "core/flatten/cut_to_disc.h"
#include "core/flatten/disc_mesh.h"

namespace curvecast {

/// A disc with its place in the parameter square. No triangle is flipped or empty.
struct Chart {
  DiscMesh disc;
  std::vector<Vec2d> uv;           // per vertex, in [0, 1]^2
  std::vector<double> area_ratio;  // per triangle: surface area over uv area
};

enum class Parameteriser {
  kOwn,   // parameterise()
  kCgal,  // parameterise_cgal(): slower and without stretch reweighting; for comparison
};

struct FlattenOptions {
  CutOptions cut;
  Parameteriser parameteriser = Parameteriser::kOwn;
  /// A chart is divided when some triangle's surface-to-uv area ratio exceeds its mean by this factor: the quadtree would go too
  /// deep for the curve's keys.
  double max_area_ratio = 1e9;
};

struct FlattenTimes {  // seconds
  double cut = 0, parameterise = 0;
};

/// One chart per component, or more where a component defeats the parameteriser (mean value weights) and uniform weights in turn,
/// and is divided into halves until it doesn't: down to single triangles, which always succeed. Every face of the mesh lies in
/// exactly one chart, whole. Charts come in the order of their components. Cancelled when the context says so (CGAL's solver ends
/// first).
absl::StatusOr<std::vector<Chart>> flatten(const TriangleMesh& mesh, const FlattenOptions& options,
                                           const ExecutionContext& context, FlattenTimes& times);

}  // namespace curvecast
