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
  EXPECT_TRUE(session->ranks({}).ok());
  return session;
}

std::size_t points_of(const Session& session) { return session.ranks({})->tree->points(); }

constexpr std::size_t kNew = kChunkStrata / 4 * 3;  // points of a chunk that continues another

/// Wants these chunks, until they are there.
RankDemand wanting(std::vector<ChunkId> chunks) {
  return [chunks = std::move(chunks)](const std::shared_ptr<const RankTree>& tree) {
    LackingRanks lacking;
    for (const ChunkId& id : chunks) {
      if (tree->find(id) == RankTree::kNone && tree->find({id.level - 1, id.index / 4}) != RankTree::kNone) {
        lacking.chunks.push_back(id);
      }
    }
    return lacking;
  };
}

TEST(RankJobs, MakeWhatLacks) {
  const auto session = make_ranked_session();
  EXPECT_EQ(points_of(*session), 4096u);
  Ends ends;
  RankJobs jobs(2, ends.counter(), make_logger(false, false));
  EXPECT_TRUE(jobs.request(session, 1, wanting({{7, 1}})));
  ASSERT_TRUE(ends.wait_for(1));
  EXPECT_EQ(points_of(*session), 4096u + kNew);
  EXPECT_TRUE(jobs.request(session, 1, wanting({{7, 0}, {8, 4}, {9, 16}})));
  ASSERT_TRUE(ends.wait_for(2));
  EXPECT_EQ(points_of(*session), 4096u + 4 * kNew);
}

TEST(RankJobs, ServeManyAtOnce) {
  const auto one = make_ranked_session(), two = make_ranked_session();
  Ends ends;
  RankJobs jobs(2, ends.counter(), make_logger(false, false));
  std::vector<ChunkId> level_7;
  for (std::uint64_t i = 0; i < 16; ++i) level_7.push_back({7, i});
  std::vector<std::jthread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint64_t i = 0; i < 20; ++i) {
        const auto& session = (t + i) % 2 ? one : two;
        EXPECT_TRUE(jobs.request(session, t, wanting(level_7)));
        EXPECT_GE(points_of(*session), 4096u);
      }
    });
  }
  threads.clear();
  EXPECT_TRUE(eventually([&] { return points_of(*one) >= 4096 + 16 * kNew && points_of(*two) >= 4096 + 16 * kNew; }));
  EXPECT_EQ(points_of(*one), 4096u + 16 * kNew);
  EXPECT_EQ(points_of(*two), 4096u + 16 * kNew);
}

TEST(RankJobs, RefuseOnceStopped) {
  const auto session = make_ranked_session();
  Ends ends;
  RankJobs jobs(2, ends.counter(), make_logger(false, false));
  jobs.request(session, 1, wanting({{7, 0}, {8, 0}, {9, 0}, {10, 0}}));
  jobs.stop();
  EXPECT_FALSE(jobs.request(session, 1, wanting({{7, 0}})));
  jobs.stop();
}

}  // namespace
}  // namespace curvecast::server
