// A session of a ball without a server, and somebody who waits for work on it to end.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/session/session.h"
#include "tests/support/shapes.h"

namespace curvecast::server {

inline constexpr auto kPatience = std::chrono::minutes(10);  // only what is broken waits that long

/// Counts how often work came to an end.
class Ends {
 public:
  /// To be called at each end, with whatever arguments.
  auto counter() {
    return [this](const auto&...) {
      const std::lock_guard lock(mutex_);
      ++count_;
      changed_.notify_all();
    };
  }
  bool wait_for(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return count_ >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

inline std::shared_ptr<Session> make_session(std::uint64_t points, const MeshFile& file) {
  absl::StatusOr<Preprocessed> done = preprocess(file, {.points = points});
  EXPECT_TRUE(done.ok()) << done.status();
  auto session = std::make_shared<Session>();
  session->id = "ball";
  session->options.points = points;
  session->preprocessed = *std::move(done);
  session->surface = std::make_shared<SessionSurface>(session->preprocessed.flattened);
  session->revisions->publish(std::move(session->preprocessed.curve));
  return session;
}

inline std::shared_ptr<Session> make_session(std::uint64_t points) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::icosphere(3));
  return make_session(points, {"ball.off", off});
}

}  // namespace curvecast::server
