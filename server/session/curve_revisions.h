// The curve of a session while it is being refined. A reader keeps the revision that it took.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "core/base/mutex.h"
#include "core/curve/surface_curve.h"

namespace curvecast::server {

/// The number of a revision that is made of the one with the number `before`. It counts, above 16 bits that tell what it is:
/// servers that refine the same curve differently do not call both the same. The first revision, 1, is the same everywhere.
constexpr std::uint64_t next_revision_number(std::uint64_t before, std::uint64_t digest) {
  constexpr int kDigestBits = 16;
  const std::uint64_t count = before >> kDigestBits > 0 ? before >> kDigestBits : before;
  return (count + 1) << kDigestBits | digest >> (64 - kDigestBits);
}

/// Thread-safe.
class CurveRevisions {
 public:
  /// The newest revision; null before the first.
  std::shared_ptr<const SurfaceCurve> newest() const {
    const MutexLock lock(mutex_);
    return curve_;
  }
  /// The first revision; null before it. Ranked points lie on it, so that they do not depend on what was refined when.
  std::shared_ptr<const SurfaceCurve> first() const {
    const MutexLock lock(mutex_);
    return first_;
  }
  /// Makes a revision the newest one.
  void publish(std::shared_ptr<const SurfaceCurve> curve) {
    const MutexLock lock(mutex_);
    if (first_ == nullptr) first_ = curve;
    curve_.swap(curve);
  }  // the old revision is destroyed after the lock is released, for that takes its time

  /// Whether a finer revision is being made or waits to be made.
  bool refining() const {
    const MutexLock lock(mutex_);
    return refining_;
  }
  void set_refining(bool refining) {
    const MutexLock lock(mutex_);
    refining_ = refining;
  }

 private:
  mutable Mutex mutex_;
  std::shared_ptr<const SurfaceCurve> first_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const SurfaceCurve> curve_ ABSL_GUARDED_BY(mutex_);
  bool refining_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace curvecast::server
