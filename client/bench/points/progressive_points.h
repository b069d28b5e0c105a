// The progressive sampler without a session around it.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>

#include "core/base/execution_context.h"
#include "core/pipeline/pipeline.h"
#include "core/progressive/grow_ranks.h"
#include "core/sample/point_set.h"

namespace curvecast::cli::bench {

class ProgressivePoints {
 public:
  /// Makes as many candidates as `points` uniform ones take. Errors as of RankGrower::make().
  static absl::StatusOr<ProgressivePoints> make(const Preprocessed& made, std::uint64_t points, std::uint64_t seed,
                                                const ExecutionContext& context);

  /// Returns n points with their places on faces; makes candidates where the density asks for more. Errors as of sample_ranked().
  absl::StatusOr<PointSet> sample(const Density& density, std::uint64_t n, const ExecutionContext& context);

 private:
  std::unique_ptr<RankGrower> grower_;
};

}  // namespace curvecast::cli::bench
