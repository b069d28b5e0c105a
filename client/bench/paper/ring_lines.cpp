#include "client/bench/paper/ring_lines.h"

#include <utility>

#include "client/bench/paper/ways.h"

namespace curvecast::cli::bench {

absl::StatusOr<std::vector<RingLine>> measure_ring_lines(const MeshFile& file, std::span<const double> sizes,
                                                         std::uint64_t curve_points, std::uint64_t seed,
                                                         const ExecutionContext& context) {
  std::vector<RingLine> lines;
  const auto most = static_cast<std::uint64_t>(sizes.back());
  const auto add = [&](const char* name, Sampler& sampler, const Sampling& sampling) -> absl::Status {
    absl::StatusOr<RingTest> test = ring_test(sampler, sampling, sizes, {.seed = seed}, context);
    if (!test.ok()) return test.status();
    lines.push_back({name, follows_density(sampling.kind) ? sampler.preprocessed().curve->size() : 0, *std::move(test)});
    return absl::OkStatus();
  };
  // The defaults last, so that only one such curve is held at a time.
  for (const Way way : {kLiteral, kDefaults}) {
    absl::StatusOr<Preprocessed> made = preprocess(file, preprocess_options(way, curve_points), context);
    if (!made.ok()) return made.status();
    Sampler sampler(*std::move(made), {}, most, seed);
    if (absl::Status status = add(kWayNames[way], sampler, kJitteredSampling); !status.ok()) return status;
    if (way == kLiteral) continue;
    std::swap(lines[kDefaults], lines[kLiteral]);
    for (const Sampling& sampling : {kProgressiveSampling, kRandomSampling, kTriangleRandomSampling}) {
      if (absl::Status status = add(sampling.name, sampler, sampling); !status.ok()) return status;
    }
  }
  return lines;
}

}  // namespace curvecast::cli::bench
