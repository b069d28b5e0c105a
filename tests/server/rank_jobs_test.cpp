#include "server/rank_jobs.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/log.h"
#include "tests/support/shapes.h"

namespace curvecast::server {
namespace {

constexpr auto kPatience = std::chrono::seconds(120);  // only a broken one waits that long

std::shared_ptr<const Session> make_session() {
  const std::string off = curvecast::testing::to_off(curvecast::testing::icosphere(3));
  absl::StatusOr<Preprocessed> done = preprocess({"ball.off", off}, {.points = 4000});
  EXPECT_TRUE(done.ok()) << done.status();
  auto session = std::make_shared<Session>();
  session->id = "ball";
  session->preprocessed = *std::move(done);
  session->live->publish(std::move(session->preprocessed.curve));
  EXPECT_TRUE(session->ranks->take(session->curve(), {}).ok());
  return session;
}

std::size_t points_of(const Session& session) { return session.ranks->take(session.curve(), {})->tree->points(); }

class Ends {
 public:
  RankJobs::OnDone counter() {
    return [this](const Session&) {
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

TEST(RankJobs, MakeWhatLacks) {
  const auto session = make_session();
  EXPECT_EQ(points_of(*session), 4096u);
  Ends ends;
  RankJobs jobs(ends.counter(), make_logger(false, false));
  EXPECT_TRUE(jobs.request(session, std::vector<ChunkId>{{7, 1}}));
  ASSERT_TRUE(ends.wait_for(1));
  EXPECT_EQ(points_of(*session), 4096u + 3072);
  EXPECT_TRUE(jobs.request(session, std::vector<ChunkId>{{7, 0}, {8, 4}}));
  ASSERT_TRUE(ends.wait_for(2));
  EXPECT_EQ(points_of(*session), 4096u + 3 * 3072);
}

TEST(RankJobs, ServeManyAtOnce) {
  const auto one = make_session(), two = make_session();
  Ends ends;
  RankJobs jobs(ends.counter(), make_logger(false, false));
  std::vector<std::jthread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < 20; ++i) {
        const auto& session = (t + i) % 2 ? one : two;
        EXPECT_TRUE(jobs.request(session, std::vector<ChunkId>{{7, i % 4}}));
        EXPECT_GE(points_of(*session), 4096u);
      }
    });
  }
  threads.clear();
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while ((points_of(*one) < 16'384 || points_of(*two) < 16'384) && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(points_of(*one), 16'384u);
  EXPECT_EQ(points_of(*two), 16'384u);
}

TEST(RankJobs, RefuseOnceStopped) {
  const auto session = make_session();
  Ends ends;
  RankJobs jobs(ends.counter(), make_logger(false, false));
  jobs.request(session, std::vector<ChunkId>{{10, 0}});
  jobs.stop();
  EXPECT_FALSE(jobs.request(session, std::vector<ChunkId>{{7, 0}}));
  jobs.stop();
}

}  // namespace
}  // namespace curvecast::server
