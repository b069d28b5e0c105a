#include "client/bench/peers/ring_test.h"

#include <cstdint>
#include <utility>

#include "core/measure/gradient.h"

namespace curvecast::cli::bench {

absl::StatusOr<RingTest> ring_test(Sampler& sampler, const Sampling& sampling, std::span<const double> sizes,
                                   const RingDiscrepancyOptions& options, const ExecutionContext& context) {
  std::vector<std::vector<std::uint32_t>> sets;
  for (const double n : sizes) {
    context.progress(sampling.name, static_cast<double>(sets.size()) / static_cast<double>(sizes.size()));
    if (absl::Status status = context.check(); !status.ok()) return status;
    absl::StatusOr<SampleSet> set = sampler.sample(sampling, static_cast<std::uint64_t>(n), context);
    if (!set.ok()) return set.status();
    sets.push_back(std::move(set->faces));
  }
  RingTest test;
  for (const Discrepancy& d : ring_discrepancy(sampler.preprocessed().flattened->loaded.mesh, sets, options, context)) {
    test.rms.push_back(d.rms);
    test.max.push_back(d.max);
  }
  if (absl::Status status = context.check(); !status.ok()) return status;
  test.rms_gradient = log_log_gradient(sizes, test.rms);
  test.max_gradient = log_log_gradient(sizes, test.max);
  return test;
}

}  // namespace curvecast::cli::bench
