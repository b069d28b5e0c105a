// The curve of a session while it is being refined: whoever takes it keeps the revision that he took.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "core/curve/surface_curve.h"

namespace curvecast::server {

/// Thread-safe.
class LiveCurve {
 public:
  /// The newest revision; null before the first.
  std::shared_ptr<const SurfaceCurve> newest() const {
    const std::lock_guard lock(mutex_);
    return curve_;
  }
  void publish(std::shared_ptr<const SurfaceCurve> curve) {
    const std::lock_guard lock(mutex_);
    curve_.swap(curve);
  }  // the old one goes after the lock, which takes its time

  /// A finer revision is being made or waits to be made.
  bool refining() const {
    const std::lock_guard lock(mutex_);
    return refining_;
  }
  void set_refining(bool refining) {
    const std::lock_guard lock(mutex_);
    refining_ = refining;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const SurfaceCurve> curve_;
  bool refining_ = false;
};

}  // namespace curvecast::server
