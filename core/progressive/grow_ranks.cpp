#include "core/progressive/grow_ranks.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/for_all.h"
#include "core/base/with_threads.h"

namespace curvecast {
namespace {

constexpr std::size_t kMaxChunksAtOnce = 1024;   // one deepen() makes no more
constexpr std::size_t kMaxKeptPoints = 750'000;  // in groups that are kept for the next grow()

/// Says whether the whole of a level is made where so many of its chunks are lacking: less work for each, and groups that wait
/// for others take most of the level with them anyway.
bool is_made_whole(int level, std::uint64_t lacking) {
  const std::uint64_t all = chunks_of_level(level);
  return lacking > (GroupOrder::is_free(level - 1) ? all / 5 * 4 : all / 3);
}

/// Calls visit(chunk, i, stratum) for the points that a tree has down to a level; stratum: that of the level.
template <typename Visit>
void visit_points(const RankTree& tree, int level, const Visit& visit) {
  for (const RankTree::Chunk& chunk : tree.chunks()) {
    if (chunk->id.level > level) break;
    for (std::size_t i = 0; i < chunk->size(); ++i) visit(*chunk, i, chunk->curve_position[i] >> (64 - 2 * level));
  }
}

std::vector<RankedPosition> positions_of(const RankTree& tree, int level) {
  std::vector<RankedPosition> positions(std::size_t{1} << 2 * level);
  visit_points(tree, level, [&](const RankChunk& chunk, std::size_t i, std::uint64_t stratum) {
    positions[stratum] = {chunk.curve_position[i], chunk.rank_of(i)};
  });
  return positions;
}

/// Whether the points that a tree has down to a level are these, to the bit.
bool has_all_points(const RankTree& tree, int level, std::span<const RankedPoint> points) {
  bool all = true;
  visit_points(tree, level, [&](const RankChunk& chunk, std::size_t i, std::uint64_t stratum) {
    const RankedPoint& p = points[stratum];
    all = all && chunk.x[i] == p.position[0] && chunk.y[i] == p.position[1] && chunk.z[i] == p.position[2] &&
          chunk.vertex[i] == p.vertex && chunk.face[i] == p.face;
  });
  return all;
}

}  // namespace

RankGrower::RankGrower(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options)
    : surface_(std::move(surface)), seed_(options.seed), strata_(*surface_), bounds_(strata_) {}

absl::StatusOr<std::unique_ptr<RankGrower>> RankGrower::make(std::shared_ptr<const LeafSurface> surface,
                                                             const ProgressiveOptions& options, const ExecutionContext& context) {
  if (options.level < kChunkLevels || options.level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(absl::StrFormat("ranks down to level %d asked for; %d to %d can be made at once",
                                                      options.level, kChunkLevels, kMaxLevelAtOnce));
  }
  std::unique_ptr<RankGrower> grower = empty(std::move(surface), options, context);
  if (absl::Status status = grower->make_whole(options.level, context); !status.ok()) return status;
  return grower;
}

std::unique_ptr<RankGrower> RankGrower::empty(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options,
                                              const ExecutionContext& context) {
  return with_threads(context, [&] { return std::unique_ptr<RankGrower>(new RankGrower(std::move(surface), options)); });
}

absl::StatusOr<std::unique_ptr<RankGrower>> RankGrower::restore(std::shared_ptr<const LeafSurface> surface,
                                                                const ProgressiveOptions& options,
                                                                std::shared_ptr<const RankTree> tree,
                                                                const ExecutionContext& context) {
  std::unique_ptr<RankGrower> grower = empty(surface, options, context);
  absl::StatusOr<ProgressiveRanks> ranks =
      ProgressiveRanks::restore(surface, options, positions_of(*tree, options.level), context);
  if (absl::IsCancelled(ranks.status())) return ranks.status();
  if (absl::Status status = surface->status(); !status.ok()) return status;
  if (!ranks.ok() || !has_all_points(*tree, options.level, ranks->points())) return make(std::move(surface), options, context);
  grower->ranks_.emplace(*std::move(ranks));
  grower->tree_ = std::move(tree);
  return grower;
}

void RankGrower::move_to(std::shared_ptr<const LeafSurface> surface) {
  strata_.move_to(*surface);
  ranks_->move_to(surface);
  surface_ = std::move(surface);
}

absl::Status RankGrower::make_whole(int level, const ExecutionContext& context) {
  if (ranks_) {
    if (absl::Status status = ranks_->extend(level, context); !status.ok()) return status;
  } else {
    absl::StatusOr<ProgressiveRanks> ranks = ProgressiveRanks::make(surface_, {.level = level, .seed = seed_}, context);
    if (!ranks.ok()) return ranks.status();
    ranks_.emplace(*std::move(ranks));
  }
  std::vector<RankTree::Chunk> chunks;
  for (int l = tree_ == nullptr ? kChunkLevels : level; l <= level; ++l) {
    const std::size_t begin = chunks.size();
    chunks.resize(begin + chunks_of_level(l));
    for_all(context, chunks.size() - begin, [&](std::size_t i) { chunks[begin + i] = whole_chunk({l, i}); });
  }
  if (absl::Status status = surface_->status(); !status.ok()) return status;
  tree_ = std::make_shared<const RankTree>(tree_ == nullptr ? RankTree(std::move(chunks))
                                                            : tree_->grown(chunks, std::numeric_limits<std::size_t>::max()));
  return absl::OkStatus();
}

/// Makes a chunk of a level that is there everywhere. The points of a level include those of lower levels: the chunk takes its
/// own from those of its stratum.
RankTree::Chunk RankGrower::whole_chunk(const ChunkId& id) const {
  const std::size_t size = ranks_->points().size() / chunks_of_level(id.level);
  std::vector<RankedPoint> points;
  for (const RankedPoint& p : ranks_->points().subspan(id.index * size, size)) {
    if (p.rank >> 2 * id.level == 0) points.push_back(p);
  }
  return std::make_shared<const RankChunk>(make_chunk(id, points, bounds_, *surface_));
}

/// Makes chunks of one level.
absl::Status RankGrower::make_chunks(std::span<const ChunkId> wanted, std::vector<RankTree::Chunk>& out,
                                     const ExecutionContext& context) {
  const int level = wanted.front().level;
  if (level <= ranks_->level()) {
    for (const ChunkId& id : wanted) out.push_back(whole_chunk(id));
    return absl::OkStatus();
  }
  std::vector<StrataRange> ranges;
  for (const ChunkId& id : wanted) ranges.push_back({id.index * kChunkStrata, (id.index + 1) * kChunkStrata});
  const auto points = ranks_->deepen(level, ranges, made_, context);
  made_.shrink(kMaxKeptPoints);
  if (!points.ok()) return points.status();
  const std::size_t begin = out.size();
  out.resize(begin + wanted.size());
  for_all(context, wanted.size(), [&](std::size_t i) {
    const auto own = std::span(*points).subspan(i * kChunkStrata, kChunkStrata);
    out[begin + i] = std::make_shared<const RankChunk>(make_chunk(wanted[i], own, bounds_, *surface_));
  });
  return absl::OkStatus();
}

absl::Status RankGrower::grow(std::span<const ChunkId> lacking, std::uint64_t max_points, const ExecutionContext& context) {
  std::vector<ChunkId> wanted(lacking.begin(), lacking.end());
  std::erase_if(wanted, [&](const ChunkId& id) { return id.level > kMaxRankLevel; });
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::vector<RankTree::Chunk> made;
  for (std::size_t begin = 0; begin < wanted.size();) {
    const int level = wanted[begin].level;
    std::size_t end = begin;
    while (end < wanted.size() && wanted[end].level == level) ++end;
    if (level == ranks_->level() + 1 && level <= kMaxLevelAtOnce && is_made_whole(level, end - begin)) {
      if (absl::Status status = make_whole(level, context); !status.ok()) return status;
      begin = end;
    }
    while (begin < end) {
      const auto some = std::span(wanted).subspan(begin, std::min(end - begin, kMaxChunksAtOnce));
      if (absl::Status status = make_chunks(some, made, context); !status.ok()) return status;
      begin += some.size();
    }
  }
  if (absl::Status status = surface_->status(); !status.ok()) return status;
  tree_ = std::make_shared<const RankTree>(tree_->grown(made, max_points));
  return absl::OkStatus();
}

}  // namespace curvecast
