#include "core/progressive/progressive.h"

#include <absl/strings/str_format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/random.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "ranks";

using Blocks = std::vector<std::uint64_t>;

RankedPoint first_point(const CurveStrata& strata, std::uint64_t seed) {
  const std::uint64_t coordinate = mix_bits(seed);
  const SurfaceCurve& curve = strata.curve();
  const std::uint32_t l = strata.vertex_at(curve_coordinate(coordinate));
  return {coordinate, {curve.x[l], curve.y[l], curve.z[l]}, {curve.nx[l], curve.ny[l], curve.nz[l]}, l, 0};
}

/// Makes a block's points. base_of(i) are the points of lower ranks of block i of the same level, filled(i) all points of one
/// that comes before.
template <typename BaseOf, typename Filled>
void make_block(const CurveStrata& strata, const BlockOrder& order, const RankBlock& block, const Blocks& near_blocks,
                std::uint64_t seed, BaseOf&& base_of, Filled&& filled, std::span<RankedPoint> points) {
  const Eigen::AlignedBox3f box = order.box(block);
  const float reach = rank_reach(strata.total_area(), block.level);
  std::vector<RankedPoint> done, open;
  for (const std::uint64_t i : near_blocks) {
    if (i == block.index) continue;
    const bool is_filled = BlockOrder::precedes(block.level, i, block.index);
    std::vector<RankedPoint>& near = is_filled ? done : open;
    for (const RankedPoint& p : is_filled ? filled(i) : base_of(i)) {
      const Vec3f position(p.position[0], p.position[1], p.position[2]);
      if (box.squaredExteriorDistance(position) <= reach * reach) near.push_back(p);
    }
  }
  fill_rank_block(strata, block, base_of(block.index), done, open, seed, points);
}

/// The blocks of a level in waves: each has to wait for blocks of earlier waves only.
std::vector<Blocks> waves_of(int level, std::span<const Blocks> near) {
  Blocks sorted(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) sorted[i] = i;
  std::sort(sorted.begin(), sorted.end(), [&](std::uint64_t a, std::uint64_t b) { return BlockOrder::precedes(level, a, b); });
  std::vector<std::size_t> wave(near.size(), 0);
  std::vector<Blocks> waves;
  for (const std::uint64_t i : sorted) {
    for (const std::uint64_t other : near[i]) {
      if (BlockOrder::precedes(level, other, i)) wave[i] = std::max(wave[i], wave[other] + 1);
    }
    if (wave[i] == waves.size()) waves.emplace_back();
    waves[wave[i]].push_back(i);
  }
  return waves;
}

/// Makes blocks as they are needed, and those that they need.
class BlockMaker {
 public:
  BlockMaker(const CurveStrata& strata, const BlockOrder& order, const ProgressiveOptions& options,
             std::span<const RankedPoint> points, DeepBlocks& made)
      : strata_(strata), order_(order), options_(options), points_(points), made_(made) {}

  std::span<const RankedPoint> filled(int level, std::uint64_t index) {
    if (const auto found = made_.filled.find({level, index}); found != made_.filled.end()) return found->second;
    const RankBlock block{level, index};
    std::vector<RankedPoint> points(4 * block.size());
    make_block(
        strata_, order_, block, near(level, index), options_.seed, [&](std::uint64_t i) { return base(level, i); },
        [&](std::uint64_t i) { return filled(level, i); }, points);
    made_.points += points.size();
    return made_.filled.emplace(DeepBlocks::Key(level, index), std::move(points)).first->second;
  }

 private:
  std::span<const RankedPoint> base(int level, std::uint64_t index) {
    const std::size_t size = RankBlock{level, index}.size();
    if (level == options_.level) return points_.subspan(index * size, size);
    return filled(level - 1, index / 4).subspan(BlockOrder::blocks(level) > 1 ? index % 4 * size : 0, size);
  }

  const Blocks& near(int level, std::uint64_t index) {
    if (const auto found = made_.near.find({level, index}); found != made_.near.end()) return found->second;
    const bool is_whole = BlockOrder::blocks(level) == 1;
    Blocks blocks = order_.near({level, index}, is_whole ? Blocks{0} : near(level - 1, index / 4));
    return made_.near.emplace(DeepBlocks::Key(level, index), std::move(blocks)).first->second;
  }

  const CurveStrata& strata_;
  const BlockOrder& order_;
  const ProgressiveOptions& options_;
  std::span<const RankedPoint> points_;
  DeepBlocks& made_;
};

absl::Status check_area(const SurfaceCurve& curve) {
  double area = 0;
  for (const float a : curve.area) {
    if (!(a >= 0)) return absl::InvalidArgumentError("the curve has an area element that is negative or not a number");
    area += static_cast<double>(a);
  }
  if (!(area > 0 && std::isfinite(area))) return absl::InvalidArgumentError("the curve has no area on which to place points");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ProgressiveRanks> ProgressiveRanks::make(std::shared_ptr<const SurfaceCurve> curve,
                                                        const ProgressiveOptions& options, const ExecutionContext& context) {
  if (options.level < 0 || options.level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(
        absl::StrFormat("ranks down to level %d asked for; 0 to %d can be made at once", options.level, kMaxLevelAtOnce));
  }
  if (absl::Status status = check_area(*curve); !status.ok()) return status;
  ProgressiveRanks ranks;
  ranks.curve_ = std::move(curve);
  ranks.options_ = {.level = 0, .seed = options.seed};
  ranks.strata_ = std::make_unique<CurveStrata>(*ranks.curve_);
  ranks.points_ = {first_point(*ranks.strata_, options.seed)};
  if (absl::Status status = ranks.fill(options.level, context); !status.ok()) return status;
  return ranks;
}

absl::Status ProgressiveRanks::extend(int level, const ExecutionContext& context) {
  if (level <= options_.level || level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(absl::StrFormat("ranks down to level %d asked for; there are %d, and at most %d", level,
                                                      options_.level, kMaxLevelAtOnce));
  }
  return fill(level, context);
}

absl::Status ProgressiveRanks::fill(int last, const ExecutionContext& context) {
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  auto order = arena.execute([&] { return std::make_unique<BlockOrder>(*strata_, last); });
  std::vector<RankedPoint> points = points_;
  std::vector<Blocks> near;
  for (int level = 0; level < last; ++level) {
    const std::size_t size = RankBlock{level, 0}.size();
    std::vector<Blocks> finer(BlockOrder::blocks(level));
    arena.execute([&] {
      tbb::parallel_for(std::size_t{0}, finer.size(), [&](std::size_t i) {
        finer[i] = order->near({level, i}, finer.size() > 1 ? near[i / 4] : Blocks{0});
      });
    });
    near = std::move(finer);
    if (level < options_.level) continue;
    std::vector<RankedPoint> next(4 * points.size());
    const auto base_of = [&](std::uint64_t i) { return std::span<const RankedPoint>(points).subspan(i * size, size); };
    const auto filled = [&](std::uint64_t i) { return std::span(next).subspan(4 * i * size, 4 * size); };
    for (const Blocks& wave : waves_of(level, near)) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      arena.execute([&] {
        tbb::parallel_for(std::size_t{0}, wave.size(), [&](std::size_t k) {
          const std::uint64_t i = wave[k];
          make_block(*strata_, *order, {level, i}, near[i], options_.seed, base_of, filled, filled(i));
        });
      });
    }
    points = std::move(next);
    context.progress(kStage, std::ldexp(1.0, 2 * (level + 1 - last)));
  }
  order_ = std::move(order);
  points_ = std::move(points);
  options_.level = last;
  return absl::OkStatus();
}

absl::StatusOr<std::vector<RankedPoint>> ProgressiveRanks::deepen(int level, std::span<const StrataRange> ranges,
                                                                  DeepBlocks& made, const ExecutionContext& context) const {
  if (level < options_.level || level > kMaxRankLevel) {
    return absl::InvalidArgumentError(
        absl::StrFormat("points of level %d asked for; there are those of %d to %d", level, options_.level, kMaxRankLevel));
  }
  const std::uint64_t strata = std::uint64_t{1} << 2 * level;
  std::uint64_t count = 0;
  for (const auto [first, last] : ranges) {
    if (first > last || last > strata) {
      return absl::InvalidArgumentError(
          absl::StrFormat("points of strata %d to %d of level %d asked for; there are %d", first, last, level, strata));
    }
    count += last - first;
  }
  if (count > kMaxDeepened) {
    return absl::InvalidArgumentError(absl::StrFormat("%d points asked for; at most %d are made in one go", count, kMaxDeepened));
  }
  std::vector<RankedPoint> points;
  points.reserve(count);
  BlockMaker blocks(*strata_, *order_, options_, points_, made);
  for (const auto [first, last] : ranges) {
    if (level == options_.level) {
      const std::span<const RankedPoint> own = std::span(points_).subspan(first, last - first);
      points.insert(points.end(), own.begin(), own.end());
      continue;
    }
    const std::uint64_t size = 4 * RankBlock{level - 1, 0}.size();
    for (std::uint64_t i = first; i < last;) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      const std::uint64_t block = i / size, next = std::min(last, (block + 1) * size);
      const std::span<const RankedPoint> filled = blocks.filled(level - 1, block).subspan(i - block * size, next - i);
      points.insert(points.end(), filled.begin(), filled.end());
      i = next;
    }
  }
  return points;
}

}  // namespace curvecast
