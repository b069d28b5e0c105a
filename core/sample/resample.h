// A point set for a view: density, then equalisation, then the points' data (paper, section 3.4).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"
#include "core/sample/point_set.h"
#include "core/sample/sequence.h"

namespace curvecast {

struct ResampleOptions {
  std::uint64_t points = 50'000;     // N, 1 .. curve.max_points
  std::vector<DensityTerm> density;  // multiplied; none = uniform
  Sequence sequence = Sequence::kJittered;
  std::uint64_t seed = 0;
};

struct ResampleTimes {  // seconds
  double density = 0;
  double equalise = 0;  // cumulative density, inversion and gathering
};

/// Exactly options.points points on the surface, low-discrepancy with respect to the density.
/// InvalidArgument: N = 0, a bad density term. OutOfRange: N > curve.max_points. FailedPrecondition: the density is zero
/// everywhere (nothing faces the eye). `times` may be null.
absl::StatusOr<PointSet> resample(const SurfaceCurve& curve, const ResampleOptions& options, ResampleTimes* times = nullptr);

}  // namespace curvecast
