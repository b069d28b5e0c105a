// Finds out how many points a view is worth.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"
#include "core/density/fixed_density.h"

namespace curvecast {

/// Returns the smallest N, 1 .. kMaxPoints, for which no point stands for more than `pixels` x `pixels` of any camera's picture:
/// M max(a / density) / pixels^2, where M is the density's mass and a the area in pixels per area of the surface (as in
/// ScreenTerm where the surface is seen at a slant). Parts of the surface without density do not count. Returns kMaxPoints where
/// more would be needed. `fixed` is what make_fixed_density() makes of the curve and the density. InvalidArgument: a bad density,
/// no camera, `pixels` not above 0; FailedPrecondition: the density is zero everywhere.
absl::StatusOr<std::uint64_t> points_for_pixel_error(const SurfaceCurve& curve, const FixedDensity* fixed, const Density& density,
                                                     double pixels);

/// Returns what global distance terms leave of `points`; at least 1. Precondition: check_density() finds nothing.
std::uint64_t scaled_points(const Density& density, const Box3d& box, std::uint64_t points);

}  // namespace curvecast
