#include "server/frame/frame_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace curvecast::server {
namespace {

FrameCache::Key key_of(std::uint64_t request) { return {.request = {request, 1}, .points = 10}; }

/// An answer of so many bytes.
Answer answer(std::uint64_t points, std::size_t bytes = 100) {
  Answer answer;
  answer.frame.set_held_points(points);
  answer.frame.add_points()->mutable_raw()->set_positions(std::string(bytes, 'p'));
  return answer;
}

TEST(FrameCache, EqualFramesAreMadeOnce) {
  FrameCache cache;
  int made = 0;
  const auto make = [&] { return absl::StatusOr<Answer>(answer(static_cast<std::uint64_t>(++made))); };
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cache.get(key_of(1), make)->frame.held_points(), 1u);
    EXPECT_EQ(cache.get(key_of(2), make)->frame.held_points(), 2u);
  }
  EXPECT_EQ(made, 2);
  EXPECT_EQ(cache.shared(), 4u);
}

TEST(FrameCache, TellsAllApartThatAFrameDependsOn) {
  FrameCache cache;
  std::uint64_t made = 0;
  const auto make = [&] { return absl::StatusOr<Answer>(answer(++made)); };
  const FrameCache::Key key = key_of(1);
  std::vector<FrameCache::Key> keys(6, key);
  keys[1].curve = std::make_shared<const SurfaceCurve>();
  keys[2].request[1] = 7;
  keys[3].points = 7;
  keys[4].reference = 7;
  keys[5].first_bytes = 7;
  for (std::size_t i = 0; i < keys.size(); ++i) EXPECT_EQ(cache.get(keys[i], make)->frame.held_points(), i + 1);
  EXPECT_EQ(cache.shared(), 0u);
}

TEST(FrameCache, WhatIsToBeImprovedAndWhatFailedIsNotShared) {
  FrameCache cache;
  int made = 0;
  const auto coarse = [&]() -> absl::StatusOr<Answer> {
    Answer out = answer(static_cast<std::uint64_t>(++made));
    out.follow_up = made % 2 == 0 ? FollowUp::kNextPart : FollowUp::kAfterImprovement;
    return out;
  };
  const auto fails = [&]() -> absl::StatusOr<Answer> {
    ++made;
    return absl::CancelledError("gone");
  };
  const auto throws = [&]() -> absl::StatusOr<Answer> {
    ++made;
    throw std::runtime_error("broken");
  };
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(cache.get(key_of(1), coarse).ok());
    EXPECT_FALSE(cache.get(key_of(1), fails).ok());
    EXPECT_THROW((void)cache.get(key_of(1), throws), std::runtime_error);
  }
  EXPECT_EQ(made, 6);
}

TEST(FrameCache, ForgetsWithTimeAndForRoom) {
  FrameCache cache;
  int made = 0;
  const auto make = [&](std::size_t bytes) {
    return [&made, bytes] { return absl::StatusOr<Answer>(answer(static_cast<std::uint64_t>(++made), bytes)); };
  };
  (void)cache.get(key_of(1), make(100));
  cache.forget_before(FrameCache::Clock::now() + std::chrono::hours(1));
  (void)cache.get(key_of(1), make(100));
  EXPECT_EQ(made, 2);
  cache.forget_before(FrameCache::Clock::now() - std::chrono::hours(1));
  (void)cache.get(key_of(1), make(100));
  EXPECT_EQ(made, 2);
  for (std::uint64_t i = 2; i < 10; ++i) (void)cache.get(key_of(i), make(3 << 20));  // more than there is room for
  (void)cache.get(key_of(1), make(100));
  EXPECT_EQ(made, 11);
  (void)cache.get(key_of(9), make(100));
  EXPECT_EQ(made, 11);
  for (int i = 0; i < 2; ++i) (void)cache.get(key_of(10), make(20 << 20));  // there is never room for
  EXPECT_EQ(made, 13);
}

TEST(FrameCache, WhoComesMeanwhileWaits) {
  constexpr int kThreads = 4, kRounds = 200;
  FrameCache cache;
  std::atomic<int> made = 0;
  std::vector<std::jthread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < kRounds; ++i) {
        const auto got = cache.get(key_of(i), [&]() -> absl::StatusOr<Answer> {
          if (t == 0 && i % 10 == 0) return absl::CancelledError("gone");  // others make it after all
          ++made;
          std::this_thread::yield();
          return answer(i);
        });
        EXPECT_EQ(got.ok() ? got->frame.held_points() : i, i);
      }
    });
  }
  threads.clear();
  EXPECT_EQ(made, kRounds);
}

}  // namespace
}  // namespace curvecast::server
