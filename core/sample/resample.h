// The equalised sampler: makes a point set for a view from a density, by equalisation (paper, section 3.4).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"
#include "core/density/fixed_density.h"
#include "core/sample/point_set.h"
#include "core/sample/resample_workspace.h"
#include "core/sample/sequence.h"

namespace curvecast {

struct ResampleOptions {
  std::uint64_t points = 50'000;  // N, 1 .. kMaxPoints
  Density density;                // none = uniform
  Sequence sequence = Sequence::kJittered;
  std::uint64_t seed = 0;
};

struct ResampleReport {
  double density_seconds = 0;
  double equalise_seconds = 0;  // cumulative density, inversion and gathering
  double gather_seconds = 0;    // of these: reading the points' data
  double most_on_vertex = 0;    // lower bound of the points expected on the curve vertex with the most; see kMaxVertexLoad
};

/// Checks what both samplers are asked for. InvalidArgument: N = 0, a bad density. OutOfRange: N > kMaxPoints.
absl::Status check_sample(std::uint64_t points, const Density& density);
/// Returns the error FailedPrecondition: the density is zero everywhere.
absl::Status nowhere_to_put_points();

/// Makes exactly options.points points on the surface, with low discrepancy with respect to the density. Where the curve is too
/// coarse for so many, points coincide.
/// InvalidArgument: N = 0, a bad density term. OutOfRange: N > kMaxPoints. FailedPrecondition: the density is zero everywhere
/// (nothing faces the eye). `report` may be null.
absl::StatusOr<PointSet> resample(const SurfaceCurve& curve, const ResampleOptions& options, ResampleReport* report = nullptr);

/// Does the same for one frame after another. Writes the points to workspace.points; what was there is lost even where it fails.
/// `fixed` is what make_fixed_density() makes of the curve and options.density: keep it from frame to frame.
absl::Status resample(const SurfaceCurve& curve, const FixedDensity* fixed, const ResampleOptions& options,
                      ResampleWorkspace& workspace, ResampleReport* report = nullptr);

}  // namespace curvecast
