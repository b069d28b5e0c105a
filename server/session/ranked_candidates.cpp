#include "server/session/ranked_candidates.h"

#include <utility>

namespace curvecast::server {
namespace {

// Takes a tenth of a second; what a view needs beyond is made for it.
constexpr int kFirstLevel = kChunkLevels;

}  // namespace

absl::StatusOr<RankedCurve> RankedCandidates::take(const std::shared_ptr<const SurfaceCurve>& curve,
                                                   const ExecutionContext& context) {
  {
    const MutexLock lock(mutex_);
    if (newest_.tree != nullptr) return newest_;
  }
  const MutexLock growing(growing_);
  if (grower_ == nullptr) {
    absl::StatusOr<std::unique_ptr<RankGrower>> grower = RankGrower::make(curve, {.level = kFirstLevel}, context);
    if (!grower.ok()) return grower.status();
    grower_ = *std::move(grower);
    const MutexLock lock(mutex_);
    newest_ = {curve, grower_->tree()};
  }
  const MutexLock lock(mutex_);
  return newest_;
}

absl::Status RankedCandidates::grow(std::span<const ChunkId> lacking, const ExecutionContext& context) {
  const MutexLock growing(growing_);
  absl::Status status = grower_->grow(lacking, kMaxPoints, context);
  if (absl::IsResourceExhausted(status)) full_ = true;
  const MutexLock lock(mutex_);
  newest_.tree = grower_->tree();
  grower_bytes_ = grower_->byte_size();
  return status;
}

std::uint64_t RankedCandidates::byte_size() {
  const MutexLock lock(mutex_);
  return newest_.tree != nullptr ? newest_.tree->byte_size() + grower_bytes_ : 0;
}

}  // namespace curvecast::server
