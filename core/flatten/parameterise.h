// Maps a disc to the unit square with positive weights, so that no triangle flips.
// Source: Floater, "Mean value coordinates" (2003), on the border of Floater, "Parametrization and smooth approximation of
// surface triangulations" (1997); paper, section 3.1. Stretch: Yoshizawa, Belyaev, Seidel, "A fast and simple stretch-minimizing
// mesh parameterization" (2004).
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/disc_mesh.h"

namespace curvecast {

enum class ParameterWeights {
  kMeanValue,  // keeps triangle shapes
  kUniform,    // Tutte's barycentric map: more distortion, more robust
};

struct ParameteriseOptions {
  ParameterWeights weights = ParameterWeights::kMeanValue;
  int reweightings = 2;  // count: solve again with weights divided by the stretch, while that lowers it (mean value weights only)
  double good_stretch = 1.6;  // L2 stretch, 1 = isometric, at which there is no need to go on
};

/// uv in [0, 1]^2 of every vertex of the disc. The border goes once around the square, spaced by arc length, with a vertex on
/// each corner, so that the parameter mesh covers the square exactly. Positive weights make every inner vertex a mean of its
/// neighbours, so no triangle flips but by rounding: the caller checks. Of the maps tried the one with the lowest stretch wins.
/// Internal when the linear system cannot be solved; Cancelled when the context says so, once a step under way is over: the
/// assembly, the factorisation or the solution of one system.
absl::StatusOr<std::vector<Vec2d>> parameterise(const DiscMesh& disc, const ParameteriseOptions& options = {},
                                                const ExecutionContext& context = {});

/// Does as parameterise() for a border that is there already: `uv` of its vertices counts, and is kept.
absl::StatusOr<std::vector<Vec2d>> parameterise_inside(const DiscMesh& disc, std::vector<Vec2d> uv,
                                                       const ParameteriseOptions& options = {},
                                                       const ExecutionContext& context = {});

}  // namespace curvecast
