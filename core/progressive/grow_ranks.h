// Makes ranked candidates where views need them: first those of the lowest ranks everywhere, then more in single places.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/progressive/progressive.h"
#include "core/progressive/rank_tree.h"
#include "core/progressive/stratum_bounds.h"

namespace curvecast {

/// The first revision of a curve and all candidates on it. They stay where they are when the curve is refined later. Not for
/// several threads at once; the trees that it gives are for anyone.
class RankGrower {
 public:
  /// With the 4^level lowest ranks, level kChunkLevels to kMaxLevelAtOnce. Errors as of ProgressiveRanks::make().
  static absl::StatusOr<std::unique_ptr<RankGrower>> make(std::shared_ptr<const SurfaceCurve> curve,
                                                          const ProgressiveOptions& options,
                                                          const ExecutionContext& context = {});

  const SurfaceCurve& curve() const { return *curve_; }
  /// What there is by now.
  std::shared_ptr<const RankTree> tree() const { return tree_; }
  /// Of what is kept from one grow() to the next besides the tree: at most some 50 MB.
  std::size_t byte_size() const { return made_.points * sizeof(RankedPoint); }

  /// Makes what is lacking, and with it what that continues; nothing deeper than tree()->deepest(), where a curve vertex has
  /// eight points to itself. ResourceExhausted: the tree would have more than `max_points`. Cancelled.
  absl::Status grow(std::span<const ChunkId> lacking, std::uint64_t max_points, const ExecutionContext& context = {});

 private:
  RankGrower(std::shared_ptr<const SurfaceCurve> curve, const ProgressiveOptions& options);
  absl::Status make_whole(int level, const ExecutionContext& context);
  absl::Status make_chunks(std::span<const ChunkId> wanted, std::vector<RankTree::Chunk>& out, const ExecutionContext& context);

  const std::shared_ptr<const SurfaceCurve> curve_;
  const std::uint64_t seed_;
  const CurveStrata strata_;
  const StratumBounds bounds_;
  std::optional<ProgressiveRanks> ranks_;
  DeepBlocks made_;  // for what will be asked for next
  std::shared_ptr<const RankTree> tree_;
};

}  // namespace curvecast
