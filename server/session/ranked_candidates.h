// The ranked candidates of a session while they grow. A reader keeps the tree that it took.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
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
  /// About how many candidates a session keeps, of some 50 bytes each: of more, those that no view looked at of late are let go.
  static constexpr std::uint64_t kMaxPoints = 6'000'000;

  using Surface = std::function<absl::StatusOr<std::shared_ptr<const LeafSurface>>()>;

  /// The level of the candidates that take() makes at first, at most.
  static constexpr int kMostLevelsAtFirst = 8;

  /// Takes candidates that were made before, on `surface`, all down to a level, with places by `seed`: take() returns them, and
  /// the surface is asked for only when they grow. Precondition: take() has not been called.
  void restore(RankedCurve made, int level, std::uint64_t seed, Surface surface) ABSL_LOCKS_EXCLUDED(growing_, mutex_);

  /// Returns the candidates that there are by now. The first call makes those of the lowest ranks, on `surface`, about as many as
  /// views of `max_points` points take, with places by `seed`; others wait for it. Errors of `surface`, and as of
  /// RankGrower::make().
  absl::StatusOr<RankedCurve> take(const Surface& surface, std::uint64_t max_points, std::uint64_t seed,
                                   const ExecutionContext& context) ABSL_LOCKS_EXCLUDED(growing_, mutex_);

  /// Makes the chunks that are lacking, if they still are; one caller after the other. Returns the candidates that there are
  /// then. Errors as of RankGrower::grow() and RankGrower::restore(). Precondition: take() has returned candidates.
  absl::StatusOr<RankedCurve> grow(std::span<const ChunkId> lacking, const ExecutionContext& context)
      ABSL_LOCKS_EXCLUDED(growing_, mutex_);

  /// From now on, the same surface is taken from there, if candidates have been made. Errors of `surface`.
  absl::Status move_to(const Surface& surface) ABSL_LOCKS_EXCLUDED(growing_, mutex_);

  /// Returns the candidates that there are by now; null where there are none yet.
  RankedCurve made() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Returns the same where a good part of them has been made since restore(), since the first ones were, and since those
  /// returned last: then they are worth keeping. Else null.
  RankedCurve take_grown() ABSL_LOCKS_EXCLUDED(mutex_);

  /// Bytes of the candidates, and of what growing keeps.
  std::uint64_t byte_size() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  /// What a grower is made of when candidates that were restored grow.
  struct Restored {
    int level;
    std::uint64_t seed;
    Surface surface;
  };

  Mutex growing_ ABSL_ACQUIRED_BEFORE(mutex_);
  std::optional<Restored> restored_ ABSL_GUARDED_BY(growing_);  // until then
  std::unique_ptr<RankGrower> grower_ ABSL_GUARDED_BY(growing_);
  Mutex mutex_;
  RankedCurve newest_ ABSL_GUARDED_BY(mutex_);
  std::size_t chunks_made_ ABSL_GUARDED_BY(mutex_) = 0;  // since take_grown() returned some
  std::uint64_t grower_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast::server
