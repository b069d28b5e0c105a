#include "server/session/ranked_candidates.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace curvecast::server {
namespace {

constexpr std::size_t kGoodPart = 8;  // an eighth of the chunks: so all that is kept of a session is written 8 times, about

/// Returns the level with at least as many points. What a view needs beyond is made for it: 65,536 candidates take two cores two
/// seconds.
int first_level(std::uint64_t max_points) {
  const int level = (std::bit_width(std::max<std::uint64_t>(max_points, 1) - 1) + 1) / 2;
  return std::clamp(level, kChunkLevels, RankedCandidates::kMostLevelsAtFirst);
}

}  // namespace

void RankedCandidates::restore(RankedCurve made, int level, std::uint64_t seed, Surface surface) {
  const MutexLock growing(growing_);
  restored_ = {level, seed, std::move(surface)};
  const MutexLock lock(mutex_);
  newest_ = std::move(made);
}

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
    auto grower = RankGrower::make(*std::move(leaves), {.level = first_level(max_points), .seed = seed}, context);
    if (!grower.ok()) return grower.status();
    grower_ = *std::move(grower);
    const MutexLock lock(mutex_);
    newest_ = {grower_->shared_curve(), grower_->tree()};
  }
  const MutexLock lock(mutex_);
  return newest_;
}

absl::StatusOr<RankedCurve> RankedCandidates::grow(std::span<const ChunkId> lacking, const ExecutionContext& context) {
  const MutexLock growing(growing_);
  if (restored_) {
    absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves = restored_->surface();
    if (!leaves.ok()) return leaves.status();
    auto grower =
        RankGrower::restore(*std::move(leaves), {.level = restored_->level, .seed = restored_->seed}, made().tree, context);
    if (!grower.ok()) return grower.status();
    grower_ = *std::move(grower);
    restored_.reset();
  }
  absl::Status status = grower_->grow(lacking, kMaxPoints, context);
  const MutexLock lock(mutex_);
  newest_.tree = grower_->tree();
  chunks_made_ += lacking.size();
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

RankedCurve RankedCandidates::made() {
  const MutexLock lock(mutex_);
  return newest_;
}

RankedCurve RankedCandidates::take_grown() {
  const MutexLock lock(mutex_);
  if (newest_.tree == nullptr || chunks_made_ * kGoodPart < newest_.tree->chunks().size()) return {};
  chunks_made_ = 0;
  return newest_;
}

std::uint64_t RankedCandidates::byte_size() {
  const MutexLock lock(mutex_);
  return newest_.tree != nullptr ? newest_.tree->byte_size() + grower_bytes_ : 0;
}

}  // namespace curvecast::server
