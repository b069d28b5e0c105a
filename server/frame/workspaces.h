// Memory for the frames of all conversations: as much as there are frames in the making at once.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/progressive/ranked_workspace.h"
#include "core/sample/resample_workspace.h"

namespace curvecast::server {

/// Memory for a frame of either sampler.
struct ViewWorkspace {
  ResampleWorkspace equalised;
  RankedWorkspace ranked;

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const { return equalised.byte_size() + ranked.byte_size(); }
};

/// Thread-safe. Outlives what it lends.
class Workspaces {
 public:
  Workspaces() { idle_.reserve(kMostIdle); }

  /// Gives a workspace back; what it holds is used again.
  struct Return {
    Workspaces* to;
    void operator()(ViewWorkspace* workspace) const { to->put(std::unique_ptr<ViewWorkspace>(workspace)); }
  };
  using Lease = std::unique_ptr<ViewWorkspace, Return>;

  Lease take() {
    std::unique_ptr<ViewWorkspace> workspace;
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        workspace = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    if (workspace == nullptr) workspace = std::make_unique<ViewWorkspace>();
    return Lease(workspace.release(), Return{this});
  }

  std::size_t idle() const {
    const std::lock_guard lock(mutex_);
    return idle_.size();
  }

 private:
  // What single large point sets took is not held for ever.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  static constexpr std::size_t kMostIdle = 16;

  void put(std::unique_ptr<ViewWorkspace> workspace) noexcept {
    workspace->ranked.selection.tree.reset();  // it may be large, and others wait for its place
    if (workspace->byte_size() > kMostBytes) return;
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kMostIdle) idle_.push_back(std::move(workspace));
  }

  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<ViewWorkspace>> idle_;  // has room for all from the beginning: put() must not fail
};

}  // namespace curvecast::server
