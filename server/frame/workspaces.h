// Lends memory to the frames of all conversations: as much as there are frames in the making at once.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "core/progressive/ranked_workspace.h"
#include "core/sample/resample_workspace.h"

namespace curvecast::server {

/// Memory for a frame of either sampler.
struct ViewWorkspace {
  ResampleWorkspace equalised;
  RankedWorkspace ranked;

  /// Returns the bytes allocated, in use or not.
  std::size_t byte_size() const { return equalised.byte_size() + ranked.byte_size(); }
};

/// Thread-safe. Outlives what it lends.
class Workspaces {
 public:
  Workspaces() { idle_.reserve(kMostIdle); }

  /// Gives a workspace back, so that its memory is used again.
  struct Return {
    Workspaces* to;
    void operator()(ViewWorkspace* workspace) const { to->give_back(std::unique_ptr<ViewWorkspace>(workspace)); }
  };
  using Lease = std::unique_ptr<ViewWorkspace, Return>;

  /// Lends the workspace that was given back last, or a new one.
  Lease lease() ABSL_LOCKS_EXCLUDED(mutex_) {
    std::unique_ptr<ViewWorkspace> workspace;
    {
      const MutexLock lock(mutex_);
      if (!idle_.empty()) {
        workspace = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    if (workspace == nullptr) workspace = std::make_unique<ViewWorkspace>();
    return Lease(workspace.release(), Return{this});
  }

  /// Returns the bytes of the workspaces that are kept and not lent.
  std::size_t byte_size() const ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    std::size_t bytes = 0;
    for (const auto& workspace : idle_) bytes += workspace->byte_size();
    return bytes;
  }
  /// Frees those.
  void clear() ABSL_LOCKS_EXCLUDED(mutex_) {
    std::vector<std::unique_ptr<ViewWorkspace>> idle;  // outlives the lock
    idle.reserve(kMostIdle);
    const MutexLock lock(mutex_);
    idle_.swap(idle);
  }
  /// Returns how many workspaces are kept and not lent.
  std::size_t idle() const ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    return idle_.size();
  }

 private:
  // What single large point sets took is freed.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  static constexpr std::size_t kMostIdle = 16;

  void give_back(std::unique_ptr<ViewWorkspace> workspace) noexcept ABSL_LOCKS_EXCLUDED(mutex_) {
    // They may be large, and may be the last of a session that has gone.
    workspace->ranked.selection.tree.reset();
    workspace->ranked.selection.parts.clear();
    if (workspace->byte_size() > kMostBytes) return;
    const MutexLock lock(mutex_);
    if (idle_.size() < kMostIdle) idle_.push_back(std::move(workspace));
  }

  mutable Mutex mutex_;
  /// Has room for kMostIdle from the beginning: give_back() must not fail.
  std::vector<std::unique_ptr<ViewWorkspace>> idle_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
