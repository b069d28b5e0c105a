// The ranked candidates of a session while they grow. A reader keeps the tree that it took.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/execution_context.h"
#include "core/base/mutex.h"
#include "core/progressive/grow_ranks.h"

namespace curvecast::server {

struct RankedCurve {
  std::shared_ptr<const SurfaceCurve> curve;  // the revision on which they were made
  std::shared_ptr<const RankTree> tree;
};

/// Thread-safe.
class RankedCandidates {
 public:
  /// Most candidates of a session, of some 26 bytes each.
  static constexpr std::uint64_t kMaxPoints = 8'000'000;

  /// Returns the candidates that there are by now. The first call makes those of the lowest ranks, on `curve`; others wait for
  /// it. Errors as of RankGrower::make().
  absl::StatusOr<RankedCurve> take(const std::shared_ptr<const SurfaceCurve>& curve, const ExecutionContext& context);

  /// Makes the chunks that are lacking, if they still are; one caller after the other. Errors as of RankGrower::grow().
  /// Precondition: take() has returned candidates.
  absl::Status grow(std::span<const ChunkId> lacking, const ExecutionContext& context);

  /// Bytes of the candidates, and of what growing keeps.
  std::uint64_t byte_size();

  /// Whether something could not be made for want of room: views that lack it do with what there is.
  bool is_full() const { return full_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> full_ = false;
  Mutex growing_ ABSL_ACQUIRED_BEFORE(mutex_);
  std::unique_ptr<RankGrower> grower_ ABSL_GUARDED_BY(growing_);
  Mutex mutex_;
  RankedCurve newest_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t grower_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast::server
