// The progressive sampler's candidates: points with fixed ranks, of which a view shows those that its density affords. Raising
// the density only adds points, lowering it only removes some; nothing else moves.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/base/execution_context.h"
#include "core/curve/surface_curve.h"
#include "core/progressive/block_order.h"
#include "core/progressive/curve_strata.h"
#include "core/progressive/rank_block.h"

namespace curvecast {

/// Ranks have 32 bits.
inline constexpr int kMaxRankLevel = 15;
inline constexpr int kMaxLevelAtOnce = 11;
/// Points that deepen() makes at most.
inline constexpr std::uint64_t kMaxDeepened = 4'000'000;

struct ProgressiveOptions {
  int level = 9;           // 4^level points are made at once, 0 .. kMaxLevelAtOnce
  std::uint64_t seed = 0;  // of their places
};

/// The strata [first, last) of a level.
struct StrataRange {
  std::uint64_t first, last;
};

/// Blocks of deep levels that were made on the way to parts of these: most of the work for parts nearby. Of one ProgressiveRanks.
struct DeepBlocks {
  using Key = std::pair<int, std::uint64_t>;  // level and index
  std::map<Key, std::vector<RankedPoint>> filled;
  std::map<Key, std::vector<std::uint64_t>> near;
  std::size_t points = 0;
};

/// Points on the whole curve, made at once down to a level and in parts of it as deep as one likes. For every l the points of the
/// 4^l lowest ranks have one in each stratum of level l. The same for any number of threads. Immutable: any number of threads may
/// ask.
class ProgressiveRanks {
 public:
  /// InvalidArgument: the level is out of range, the curve has no area. Cancelled.
  static absl::StatusOr<ProgressiveRanks> make(std::shared_ptr<const SurfaceCurve> curve, const ProgressiveOptions& options,
                                               const ExecutionContext& context = {});

  /// Makes all points down to a deeper level, at most kMaxLevelAtOnce; those that there are stay. Not while others ask.
  /// InvalidArgument: the level is not deeper. Cancelled, and nothing has changed.
  absl::Status extend(int level, const ExecutionContext& context = {});

  const SurfaceCurve& curve() const { return *curve_; }
  int level() const { return options_.level; }
  /// 4^level() points in curve order: the i-th lies in stratum i of that level.
  std::span<const RankedPoint> points() const { return points_; }

  /// Of a deeper level the points of some strata, one in each, range by range, each in curve order. They are what making all at
  /// once down to that level would give. What lies around them has to be made too, but for what is in `made`, to which it is
  /// added: rather ask for many ranges in one call. InvalidArgument: a level not in level() .. kMaxRankLevel, strata that there
  /// are not, more than kMaxDeepened points. Cancelled.
  absl::StatusOr<std::vector<RankedPoint>> deepen(int level, std::span<const StrataRange> ranges, DeepBlocks& made,
                                                  const ExecutionContext& context = {}) const;

 private:
  ProgressiveRanks() = default;
  absl::Status fill(int level, const ExecutionContext& context);

  std::shared_ptr<const SurfaceCurve> curve_;
  ProgressiveOptions options_;
  std::unique_ptr<const CurveStrata> strata_;
  std::unique_ptr<const BlockOrder> order_;
  std::vector<RankedPoint> points_;
};

}  // namespace curvecast
