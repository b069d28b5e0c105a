// Makes the ranked points that views need: first the lowest ranks everywhere, then higher ones in single parts of the surface.
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

/// The first revision of a curve and the ranked points on it. The points stay where they are when the curve is refined later. Not
/// for several threads at once; the trees that it gives may be read by any number of threads.
class RankGrower {
 public:
  /// Makes the 4^options.level lowest ranks; options.level is kChunkLevels to kMaxLevelAtOnce. Errors: see
  /// ProgressiveRanks::make().
  static absl::StatusOr<std::unique_ptr<RankGrower>> make(std::shared_ptr<const LeafSurface> surface,
                                                          const ProgressiveOptions& options,
                                                          const ExecutionContext& context = {});

  /// Returns a grower that goes on from a tree that another one with the same options made on the same surface; options.level, at
  /// most kFirstFreeLevel, says down to where it has all chunks. Where the surface does not have the tree's points, they are all
  /// made anew. Errors as of make().
  static absl::StatusOr<std::unique_ptr<RankGrower>> restore(std::shared_ptr<const LeafSurface> surface,
                                                             const ProgressiveOptions& options,
                                                             std::shared_ptr<const RankTree> tree,
                                                             const ExecutionContext& context = {});

  const SurfaceCurve& curve() const { return surface_->curve(); }
  std::shared_ptr<const SurfaceCurve> shared_curve() const { return surface_->shared_curve(); }
  /// Returns the points that were made and not been let go of.
  std::shared_ptr<const RankTree> tree() const { return tree_; }
  /// Returns the bytes of what grow() keeps for the next grow(), besides the tree.
  std::size_t byte_size() const { return ranks_->points().size_bytes() + made_.byte_size(); }

  /// From now on, the same surface, with the same curve, is taken from there.
  void move_to(std::shared_ptr<const LeafSurface> surface);

  /// Makes the chunks `lacking`, down to level kMaxRankLevel. A chunk whose parent the tree lacks is left out of the tree. Where
  /// the tree has more than `max_points` then, it lets go of chunks that were not used since it grew last (see
  /// RankTree::grown()); made again they are the same. Cancelled, DataLoss (the surface is damaged): the tree is
  /// as before.
  absl::Status grow(std::span<const ChunkId> lacking, std::uint64_t max_points, const ExecutionContext& context = {});

 private:
  RankGrower(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options);
  static std::unique_ptr<RankGrower> empty(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options,
                                           const ExecutionContext& context);
  absl::Status make_whole(int level, const ExecutionContext& context);
  RankTree::Chunk whole_chunk(const ChunkId& id) const;
  absl::Status make_chunks(std::span<const ChunkId> wanted, std::vector<RankTree::Chunk>& out, const ExecutionContext& context);

  std::shared_ptr<const LeafSurface> surface_;
  const std::uint64_t seed_;
  CurveStrata strata_;
  const StratumBounds bounds_;
  std::optional<ProgressiveRanks> ranks_;
  DeepGroups made_;  // kept for the next grow()
  std::shared_ptr<const RankTree> tree_;
};

}  // namespace curvecast
