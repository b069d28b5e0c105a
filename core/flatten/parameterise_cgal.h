// CGAL's own mean value parameteriser, as a reference for ours and as an alternative to it.
// Source: CGAL 5.5, package Surface_mesh_parameterization; Floater, "Mean value coordinates" (2003).
#pragma once

#include <absl/status/statusor.h>

#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/disc_mesh.h"

namespace curvecast {

/// The preconditioner of CGAL's iterative solver, Eigen's BiCGSTAB.
enum class CgalPreconditioner {
  kIncompleteLu,  // Eigen's IncompleteLUT: what Mean_value_coordinates_parameterizer_3 has by default
  kDiagonal,      // what CGAL::Eigen_solver_traits has by default
};

/// uv in [0, 1]^2 of every vertex of the disc, by CGAL's Mean_value_coordinates_parameterizer_3 with its
/// Square_border_arc_length_parameterizer_3, oriented like the result of parameterise(): the border starts at (0, 0) and runs
/// counter-clockwise. CGAL chooses the corners itself: those border vertices that are nearest to quarters of the border's
/// length. Rounding and the solver's tolerance may flip triangles: the caller checks. `solve_seconds`, if not null, gets the time
/// in CGAL's algorithm, without the making of its mesh. Cancelled when the context says so.
/// InvalidArgument when CGAL takes the disc for no manifold disc, or finds no four corners on its border; Internal when CGAL
/// fails, with its message.
absl::StatusOr<std::vector<Vec2d>> parameterise_cgal(const DiscMesh& disc,
                                                     CgalPreconditioner preconditioner = CgalPreconditioner::kIncompleteLu,
                                                     double* solve_seconds = nullptr, const ExecutionContext& context = {});

}  // namespace curvecast
