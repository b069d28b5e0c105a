#include "server/session/ranked_candidates.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace curvecast::server {
namespace {

// What a view needs beyond is made for it. 65,536 candidates take two cores half a second.
constexpr int kMostLevelsAtFirst = 8;

/// Returns the level with at least as many points.
int first_level(std::uint64_t max_points) {
  const int level = (std::bit_width(std::max<std::uint64_t>(max_points, 1) - 1) + 1) / 2;
  return std::clamp(level, kChunkLevels, kMostLevelsAtFirst);
}

}  // namespace

absl::StatusOr<RankedCurve> RankedCandidates::take(const Surface& surface, std::uint64_t max_points, std::uint64_t seed,
                                                   const ExecutionContext& context) {
  {
    const MutexLock lock(mutex_);
    if (newest_.tree != nullptr) return newest_;
  }
  const MutexLock growing(growing_);
  if (grower_ == nullptr) {
    absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves = surface();
    if (!leaves.ok()) return leaves.status();
    const std::shared_ptr<const SurfaceCurve> curve = (*leaves)->shared_curve();
    absl::StatusOr<std::unique_ptr<RankGrower>> grower =
        RankGrower::make(*std::move(leaves), {.level = first_level(max_points), .seed = seed}, context);
    if (!grower.ok()) return grower.status();
    grower_ = *std::move(grower);
    const MutexLock lock(mutex_);
    newest_ = {curve, grower_->tree()};
  }
  const MutexLock lock(mutex_);
  return newest_;
}

absl::StatusOr<RankedCurve> RankedCandidates::grow(std::span<const ChunkId> lacking, const ExecutionContext& context) {
  const MutexLock growing(growing_);
  absl::Status status = grower_->grow(lacking, kMaxPoints, context);
  const MutexLock lock(mutex_);
  newest_.tree = grower_->tree();
  grower_bytes_ = grower_->byte_size();
  if (!status.ok()) return status;
  return newest_;
}

absl::Status RankedCandidates::move_to(const Surface& surface) {
  const MutexLock growing(growing_);
  if (grower_ == nullptr) return absl::OkStatus();
  absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves = surface();
  if (leaves.ok()) grower_->move_to(*std::move(leaves));
  return leaves.status();
}

std::uint64_t RankedCandidates::byte_size() {
  const MutexLock lock(mutex_);
  return newest_.tree != nullptr ? newest_.tree->byte_size() + grower_bytes_ : 0;
}

}  // namespace curvecast::server
