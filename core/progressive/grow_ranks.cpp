#include "core/progressive/grow_ranks.h"

#include <absl/strings/str_format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace curvecast {
namespace {

constexpr std::size_t kMaxChunksAtOnce = 256;      // one deepen() makes no more
constexpr std::size_t kMaxKeptPoints = 1'000'000;  // in groups that are kept for the next grow()
// Where more than this part (a third) of a level's chunks are lacking, the whole level is made: less work for each chunk, and on
// all threads.
constexpr std::uint64_t kWholeLevelPart = 3;

std::uint64_t chunks_of_level(int level) { return std::uint64_t{1} << 2 * (level - kChunkLevels); }

// Area of the deepest strata, in parts of a curve vertex' area. The smaller strata are beside leaves, the more of them count as
// near each other, and making one takes ever longer.
constexpr double kLeastStratum = 1.0 / 8;

int deepest_level(const SurfaceCurve& curve) {
  const double most = static_cast<double>(curve.size()) / kLeastStratum;
  return std::clamp(static_cast<int>(std::log2(most) / 2), kChunkLevels, kMaxRankLevel);
}

tbb::task_arena arena_of(const ExecutionContext& context) {
  return tbb::task_arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
}

}  // namespace

RankGrower::RankGrower(std::shared_ptr<const SurfaceCurve> curve, const ProgressiveOptions& options)
    : curve_(std::move(curve)), seed_(options.seed), strata_(*curve_), bounds_(strata_) {}

absl::StatusOr<std::unique_ptr<RankGrower>> RankGrower::make(std::shared_ptr<const SurfaceCurve> curve,
                                                             const ProgressiveOptions& options, const ExecutionContext& context) {
  if (options.level < kChunkLevels || options.level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(absl::StrFormat("ranks down to level %d asked for; %d to %d can be made at once",
                                                      options.level, kChunkLevels, kMaxLevelAtOnce));
  }
  std::unique_ptr<RankGrower> grower;
  arena_of(context).execute([&] { grower.reset(new RankGrower(std::move(curve), options)); });
  if (absl::Status status = grower->make_whole(options.level, context); !status.ok()) return status;
  return grower;
}

absl::Status RankGrower::make_whole(int level, const ExecutionContext& context) {
  if (ranks_) {
    if (absl::Status status = ranks_->extend(level, context); !status.ok()) return status;
  } else {
    absl::StatusOr<ProgressiveRanks> ranks = ProgressiveRanks::make(curve_, {.level = level, .seed = seed_}, context);
    if (!ranks.ok()) return ranks.status();
    ranks_.emplace(*std::move(ranks));
  }
  // The points of a level include those of lower levels: each chunk takes its own from the points of its stratum.
  std::vector<RankTree::Chunk> chunks;
  for (int l = kChunkLevels; l <= level; ++l) {
    const std::size_t begin = chunks.size();
    if (tree_ != nullptr && l < level) continue;
    chunks.resize(begin + chunks_of_level(l));
    arena_of(context).execute([&] {
      tbb::parallel_for(std::size_t{0}, chunks.size() - begin, [&](std::size_t i) {
        const std::size_t size = ranks_->points().size() / chunks_of_level(l);
        std::vector<RankedPoint> points;
        for (const RankedPoint& p : ranks_->points().subspan(i * size, size)) {
          if (p.rank >> 2 * l == 0) points.push_back(p);
        }
        chunks[begin + i] = std::make_shared<const RankChunk>(make_chunk({l, i}, points, bounds_));
      });
    });
  }
  tree_ = std::make_shared<const RankTree>(tree_ == nullptr ? RankTree(std::move(chunks), deepest_level(*curve_))
                                                            : tree_->with(chunks));
  return absl::OkStatus();
}

/// Makes chunks of one level.
absl::Status RankGrower::make_chunks(std::span<const ChunkId> wanted, std::vector<RankTree::Chunk>& out,
                                     const ExecutionContext& context) {
  std::vector<StrataRange> ranges;
  for (const ChunkId& id : wanted) ranges.push_back({id.index * kChunkStrata, (id.index + 1) * kChunkStrata});
  const auto points = ranks_->deepen(wanted.front().level, ranges, made_, context);
  if (made_.points > kMaxKeptPoints) made_ = {};
  if (!points.ok()) return points.status();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto own = std::span(*points).subspan(i * kChunkStrata, kChunkStrata);
    out.push_back(std::make_shared<const RankChunk>(make_chunk(wanted[i], own, bounds_)));
  }
  return absl::OkStatus();
}

absl::Status RankGrower::grow(std::span<const ChunkId> lacking, std::uint64_t max_points, const ExecutionContext& context) {
  std::vector<ChunkId> wanted(lacking.begin(), lacking.end());
  std::erase_if(wanted, [&](const ChunkId& id) { return id.level > tree_->deepest(); });
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  constexpr std::size_t kNewPoints = kChunkStrata - kChunkStrata / 4;
  if (tree_->points() + wanted.size() * kNewPoints > max_points) {
    return absl::ResourceExhaustedError(absl::StrFormat("the view needs more than the %d candidates that are kept", max_points));
  }
  std::vector<RankTree::Chunk> made;
  for (std::size_t begin = 0; begin < wanted.size();) {
    const int level = wanted[begin].level;
    std::size_t end = begin;
    while (end < wanted.size() && wanted[end].level == level) ++end;
    const std::uint64_t all = chunks_of_level(level);
    if (level <= kMaxLevelAtOnce && level > ranks_->level() && (end - begin) * kWholeLevelPart > all &&
        tree_->points() + all * kNewPoints <= max_points) {
      if (absl::Status status = make_whole(level, context); !status.ok()) return status;
      begin = end;
    }
    while (begin < end) {
      const auto some = std::span(wanted).subspan(begin, std::min(end - begin, kMaxChunksAtOnce));
      if (absl::Status status = make_chunks(some, made, context); !status.ok()) return status;
      begin += some.size();
    }
  }
  tree_ = std::make_shared<const RankTree>(tree_->with(made));
  return absl::OkStatus();
}

}  // namespace curvecast
