// What many use and somebody replaces now and then.
#pragma once

#include <memory>
#include <utility>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe. Whoever has taken the old one keeps it.
template <class T>
class Replaceable {
 public:
  explicit Replaceable(std::shared_ptr<const T> first) : value_(std::move(first)) {}

  std::shared_ptr<const T> get() const ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    return value_;
  }
  void replace(std::shared_ptr<const T> next) ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    value_.swap(next);
  }  // the old one is destroyed after the lock is released

 private:
  mutable Mutex mutex_;
  std::shared_ptr<const T> value_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
