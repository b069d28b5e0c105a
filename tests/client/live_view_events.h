// What a LiveView has called back, to be waited for.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "client/lib/live_view.h"

namespace curvecast::client {

/// Thread-safe. Waits end after two minutes, which only a broken view takes.
class LiveViewEvents {
 public:
  struct State {
    LiveViewState state;
    absl::Status status;
  };

  LiveViewCallbacks callbacks() {
    return {.on_frame = [this](const Frame& frame) { add(frames_, frame); },
            .on_state =
                [this](LiveViewState state, const absl::Status& status) {
                  add(states_, {state, status});
                }};
  }

  /// The frame number `index` of all.
  Frame frame(std::size_t index) { return at(frames_, index, Frame()); }
  State state(std::size_t index) { return at(states_, index, State{LiveViewState::kEnded, absl::UnknownError("nothing came")}); }
  /// How often a state has been told of so far.
  std::size_t count(LiveViewState state) {
    const std::lock_guard lock(mutex_);
    std::size_t count = 0;
    for (const State& told : states_) count += told.state == state ? 1 : 0;
    return count;
  }

 private:
  template <typename T>
  void add(std::vector<T>& list, T event) {
    const std::lock_guard lock(mutex_);
    list.push_back(std::move(event));
    changed_.notify_all();
  }
  template <typename T>
  T at(const std::vector<T>& list, std::size_t index, T otherwise) {
    std::unique_lock lock(mutex_);
    const bool came = changed_.wait_for(lock, std::chrono::minutes(2), [&] { return list.size() > index; });
    return came ? list[index] : otherwise;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Frame> frames_;
  std::vector<State> states_;
};

}  // namespace curvecast::client
