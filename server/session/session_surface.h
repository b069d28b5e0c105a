// The surface on which a session's curve lies, loaded when it is first needed.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

#include "core/base/mutex.h"
#include "core/pipeline/curve_surface.h"

namespace curvecast::server {

/// Thread-safe.
class SessionSurface {
 public:
  using Load = std::function<absl::StatusOr<std::shared_ptr<const CurveBase>>(const ExecutionContext& context)>;

  /// There is none: base() is Unavailable.
  SessionSurface() = default;
  explicit SessionSurface(Load load) : load_(std::move(load)) {}
  /// The surface is in memory; null: there is none.
  explicit SessionSurface(std::shared_ptr<const FlattenedMesh> flattened);

  /// Returns what refinement starts from. The first call that succeeds loads it, others wait. Errors are those of `load`.
  absl::StatusOr<std::shared_ptr<const CurveBase>> base(const ExecutionContext& context = {}) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Returns the surface below the leaves of a curve that lies on it: one of the session's revisions. Errors as of base();
  /// DataLoss where the curve has other discs or named values.
  absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves(const std::shared_ptr<const SurfaceCurve>& curve,
                                                            const ExecutionContext& context = {}) ABSL_LOCKS_EXCLUDED(mutex_);
  /// OK, or that the surface is damaged, as far as anybody knows: see CurveBase::status(). Waits for nobody.
  absl::Status status() const ABSL_LOCKS_EXCLUDED(loaded_mutex_);
  /// From now on, the same surface is taken from there.
  void move_to(std::shared_ptr<const CurveBase> base) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Returns the bytes of memory that the surface takes; in a mapped file it takes none that the system could not have back.
  std::uint64_t byte_size() const { return bytes_; }

 private:
  absl::Status load_base(const ExecutionContext& context) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void set_base(std::shared_ptr<const CurveBase> base) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  Mutex mutex_;
  Load load_ ABSL_GUARDED_BY(mutex_);  // empty once it is loaded
  std::shared_ptr<const CurveBase> base_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const LeafSurface> leaves_ ABSL_GUARDED_BY(mutex_);  // of the curve that was last asked for
  std::atomic<std::uint64_t> bytes_ = 0;
  mutable Mutex loaded_mutex_ ABSL_ACQUIRED_AFTER(mutex_);                  // held for no longer than it takes to copy a pointer
  std::shared_ptr<const CurveBase> loaded_ ABSL_GUARDED_BY(loaded_mutex_);  // as `base_`
};

}  // namespace curvecast::server
