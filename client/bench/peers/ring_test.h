// The paper's test of how evenly points lie on a mesh (section 4.2): with which power of their number the discrepancy falls.
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <vector>

#include "client/bench/peers/samplings.h"
#include "core/measure/ring_discrepancy.h"

namespace curvecast::cli::bench {

/// Regions overlap, so that the discrepancy of one set of random points is off by a quarter: it takes several sets of each size.
/// Of progressive points there is one order alone.
inline constexpr int kRingRuns = 4;

struct RingTest {
  std::vector<double> rms, max;  // for each size, as fractions of the whole: the RMS over the runs, and the mean
  double rms_gradient = 0, max_gradient = 0;
};

/// Samples sets of the given sizes, with as many seeds as there are runs, measures their discrepancy over rings of triangles and
/// fits the gradients. Errors as of Sampler::sample(). Preconditions: two sizes, ascending; the sampling tells its faces.
absl::StatusOr<RingTest> ring_test(Sampler& sampler, const Sampling& sampling, std::span<const double> sizes,
                                   const RingDiscrepancyOptions& options, const ExecutionContext& context);

}  // namespace curvecast::cli::bench
