// Makes a triangle mesh of points on a surface (paper, section 4.4): the points become vertices of the surface's own mesh, whose
// vertices then go, one by one. See README.md for why.
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/chart_view.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sample/point_set.h"

namespace curvecast {

inline constexpr int kMaxRelaxations = 100;

/// How points become a triangulation, before it is relaxed.
enum class RemeshMethod {
  kSurface,    // as vertices of the surface's own mesh, whose vertices then go
  kParameter,  // the paper's way: in the parameter square, whose cuts are stitched; disturbs distances along them
};

struct RemeshOptions {
  int relaxations = 5;  // rounds in which vertices move along the surface: 0 .. kMaxRelaxations
  bool fit = false;     // vertices leave the surface where triangles come nearer to it by that
  // Edges of the surface stay edges of the mesh where the normals of their faces differ by more degrees: 0 .. 180; 0: none do.
  double feature_degrees = 0;  // kSurface only
  RemeshMethod method = RemeshMethod::kSurface;
};

struct Remeshed {
  TriangleMesh mesh;              // N vertices: the surface's own that stay, those of points in their order, those on borders
  std::vector<FacePlace> places;  // N: where on the surface each vertex lies; fitted, where it lay
};

/// Makes a mesh of exactly as many vertices as there are points: manifold, oriented, of the surface's components, genus and
/// borders. A few of the surface's own vertices stay where a component has too few points to stand on, and as many points go. On
/// borders and features vertices are placed as densely as the points beside them, instead of those nearest to these.
/// `surface`: as repair() leaves it. Points may lie anywhere on it, in any order; at the same place, they are moved apart. The
/// same for any number of threads. InvalidArgument: options out of range; a point on no face or with weights that are none;
/// too few points to bear the topology: the message says about how many it takes. Cancelled; ResourceExhausted as of MemoryClaim.
/// `charts`: all of the surface's,
/// where the method is kParameter.
absl::StatusOr<Remeshed> remesh(const TriangleMesh& surface, std::span<const FacePlace> points, const RemeshOptions& options = {},
                                const ExecutionContext& context = {}, std::span<const ChartView> charts = {});

}  // namespace curvecast
