#include "client/bench/peers/ring_test.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "core/measure/gradient.h"

namespace curvecast::cli::bench {

namespace {

/// The discrepancies of one set of each size.
absl::StatusOr<std::vector<Discrepancy>> run_once(Sampler& sampler, const Sampling& sampling, std::span<const double> sizes,
                                                  const RingDiscrepancyOptions& options, const ExecutionContext& context) {
  std::vector<std::vector<std::uint32_t>> sets;
  for (const double n : sizes) {
    context.progress(sampling.name, static_cast<double>(sets.size()) / static_cast<double>(sizes.size()));
    if (absl::Status status = context.check(); !status.ok()) return status;
    absl::StatusOr<SampleSet> set = sampler.sample(sampling, static_cast<std::uint64_t>(n), context);
    if (!set.ok()) return set.status();
    sets.push_back(std::move(set->faces));
  }
  std::vector<Discrepancy> found = ring_discrepancy(sampler.preprocessed().flattened->loaded.mesh, sets, options, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  return found;
}

}  // namespace

absl::StatusOr<RingTest> ring_test(Sampler& sampler, const Sampling& sampling, std::span<const double> sizes,
                                   const RingDiscrepancyOptions& options, const ExecutionContext& context) {
  const int runs = sampling.kind == Sampling::kProgressive ? 1 : kRingRuns;
  RingTest test{std::vector<double>(sizes.size()), std::vector<double>(sizes.size())};
  for (int run = 0; run < runs; ++run) {
    Sampler other = sampler.with_seed(sampler.seed() + static_cast<std::uint64_t>(run));
    const auto found = run_once(run == 0 ? sampler : other, sampling, sizes, options, context);
    if (!found.ok()) return found.status();
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      test.rms[i] += (*found)[i].rms * (*found)[i].rms / runs;
      test.max[i] += (*found)[i].max / runs;
    }
  }
  for (double& rms : test.rms) rms = std::sqrt(rms);
  test.rms_gradient = log_log_gradient(sizes, test.rms);
  test.max_gradient = log_log_gradient(sizes, test.max);
  return test;
}

}  // namespace curvecast::cli::bench
