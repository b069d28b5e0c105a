#include "server/session/rank_jobs.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "server/base/log.h"
#include "tests/server/ball_session.h"
#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

std::shared_ptr<const Session> make_ranked_session() {
  auto session = make_session(4000);
  EXPECT_TRUE(session->candidates->take(session->curve(), {}).ok());
  return session;
}

std::size_t points_of(const Session& session) { return session.candidates->take(session.curve(), {})->tree->points(); }

TEST(RankJobs, MakeWhatLacks) {
  const auto session = make_ranked_session();
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
  const auto one = make_ranked_session(), two = make_ranked_session();
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
  EXPECT_TRUE(eventually([&] { return points_of(*one) >= 16'384 && points_of(*two) >= 16'384; }));
  EXPECT_EQ(points_of(*one), 16'384u);
  EXPECT_EQ(points_of(*two), 16'384u);
}

TEST(RankJobs, RefuseOnceStopped) {
  const auto session = make_ranked_session();
  Ends ends;
  RankJobs jobs(ends.counter(), make_logger(false, false));
  jobs.request(session, std::vector<ChunkId>{{10, 0}});
  jobs.stop();
  EXPECT_FALSE(jobs.request(session, std::vector<ChunkId>{{7, 0}}));
  jobs.stop();
}

}  // namespace
}  // namespace curvecast::server
