#include "server/base/memory_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

struct Fixture : public ::testing::Test {
  std::atomic<std::uint64_t> most = 1000, held = 0, idle = 0;
  MemoryBudget budget{{.most = [this] { return most.load(); },
                       .held = [this] { return held.load(); },
                       .make_room =
                           [this](std::uint64_t bytes) {
                             const std::uint64_t freed = std::min(bytes, idle.load());
                             idle -= freed, held -= freed;
                           },
                       .patience = std::chrono::minutes(5)}};
};
using MemoryBudgetTest = Fixture;

TEST_F(MemoryBudgetTest, RefusesWhatNeverFitsAndSaysWhatThereIs) {
  MemoryBudget::Job job(budget, nullptr);
  const absl::Status status = job.take(1001, "ten triangles take much");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("ten triangles take much; this server has 1.0 kB for all of its work"));
  EXPECT_TRUE(job.take(1000, "").ok());
  EXPECT_FALSE(job.take(1, "one more").ok());
  EXPECT_FALSE(job.take(UINT64_MAX, "and the sum is not to overflow").ok());
  EXPECT_EQ(budget.refused(), 3u);
  job.give_back(400);
  EXPECT_EQ(budget.reserved(), 600u);
}

TEST_F(MemoryBudgetTest, TellsWhatWillNeverFitWithoutTakingAnything) {
  MemoryBudget::Job job(budget, nullptr);
  ASSERT_TRUE(job.take(900, "").ok());
  MemoryBudget::Outlook outlook(budget);
  EXPECT_TRUE(outlook.take(1000, "").ok()) << "it may, later";
  EXPECT_EQ(budget.reserved(), 900u);
  EXPECT_THAT(std::string(outlook.take(1001, "ten triangles").message()),
              HasSubstr("ten triangles; this server has 1.0 kB for all of its work"));
  EXPECT_EQ(budget.refused(), 1u);
}

TEST_F(MemoryBudgetTest, GivesAllBackWithTheJob) {
  { EXPECT_TRUE(MemoryBudget::Job(budget, nullptr).take(900, "").ok()); }
  EXPECT_EQ(budget.reserved(), 0u);
}

TEST_F(MemoryBudgetTest, WhatAJobKeepsIsItsOwnUntilItGoes) {
  MemoryBudget::Job other(budget, nullptr, {.waits = false});
  {
    MemoryBudget::Job job(budget, nullptr, {.keeps = true});
    ASSERT_TRUE(job.take(700, "").ok());
    job.give_back(500);
    EXPECT_EQ(budget.reserved(), 700u);
    EXPECT_FALSE(other.take(400, "").ok());
    held = 400;
    EXPECT_TRUE(job.take(400, "").ok()) << "it has that much";
    EXPECT_FALSE(job.take(200, "").ok());
    held = 200;
    EXPECT_TRUE(job.take(200, "").ok());
    EXPECT_EQ(budget.reserved(), 800u);
    job.give_back(800);
    held = 0;
    EXPECT_TRUE(job.take(1000, "").ok()) << "all that there is, none of which it uses now";
    EXPECT_FALSE(job.take(1, "").ok());
  }
  EXPECT_EQ(budget.reserved(), 0u);
  EXPECT_TRUE(other.take(1000, "").ok());
}

TEST_F(MemoryBudgetTest, WhatWaitsLeavesAPartToWhatDoesNot) {
  MemoryBudget shared({.most = [] { return std::uint64_t{1000}; },
                       .held = [this] { return held.load(); },
                       .make_room = [](std::uint64_t) {},
                       .left_by_waiting = 0.25});
  MemoryBudget::Job session(shared, nullptr, {.keeps = true}), view(shared, nullptr, {.waits = false});
  EXPECT_EQ(session.most(), 750u) << "clients are told what would fit";
  EXPECT_THAT(std::string(session.take(751, "a session").message()), HasSubstr("this server has 750 bytes for all of its work"));
  EXPECT_FALSE(MemoryBudget::Outlook(shared).take(751, "a session").ok());
  ASSERT_TRUE(session.take(650, "").ok());
  held = 100;
  EXPECT_TRUE(view.take(250, "a view").ok());
  EXPECT_FALSE(view.take(1, "another").ok());
  EXPECT_EQ(view.most(), 1000u);
}

TEST_F(MemoryBudgetTest, MakesRoomFirst) {
  held = 800, idle = 500;
  MemoryBudget::Job job(budget, nullptr);
  EXPECT_TRUE(job.take(200, "").ok());
  EXPECT_EQ(idle, 500u) << "there was room";
  EXPECT_TRUE(job.take(300, "").ok());
  EXPECT_EQ(idle, 200u);
  EXPECT_THAT(std::string(job.take(400, "four hundred").message()), HasSubstr("too many are in use; try again later"));
}

TEST_F(MemoryBudgetTest, LooksAgainForWhatIsIdleAMomentLater) {
  held = 800;
  int looks = 0;
  MemoryBudget slow({.most = [] { return std::uint64_t{1000}; },
                     .held = [this] { return held.load(); },
                     .make_room =
                         [&](std::uint64_t bytes) {
                           if (++looks == 3) held -= bytes;
                         }});
  MemoryBudget::Job view(slow, nullptr, {.waits = false});
  EXPECT_FALSE(view.take(400, "").ok()) << "it does not wait";
  MemoryBudget::Job job(slow, nullptr);
  EXPECT_TRUE(job.take(400, "").ok()) << "nobody else runs, but who has just been answered may hold a session yet";
  EXPECT_EQ(looks, 3);
}

TEST_F(MemoryBudgetTest, WaitsForOthers) {
  auto first = std::make_unique<MemoryBudget::Job>(budget, nullptr);
  ASSERT_TRUE(first->take(700, "").ok());
  std::atomic<bool> has_it = false;
  std::jthread second([&] {
    MemoryBudget::Job job(budget, nullptr);
    EXPECT_TRUE(job.take(400, "").ok());
    has_it = true;
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(has_it);
  first.reset();
  second.join();
  EXPECT_EQ(budget.reserved(), 0u);
  EXPECT_EQ(budget.refused(), 0u);
}

TEST_F(MemoryBudgetTest, EndsWaitingWithTheClient) {
  MemoryBudget::Job first(budget, nullptr);
  ASSERT_TRUE(first.take(700, "").ok());
  std::atomic<bool> cancel = false;
  std::jthread second([&] {
    MemoryBudget::Job job(budget, &cancel);
    EXPECT_EQ(job.take(400, "").code(), absl::StatusCode::kCancelled);
  });
  cancel = true;
}

TEST_F(MemoryBudgetTest, LetsOneOfThoseThatWaitForEachOtherGoOn) {
  std::atomic<int> ready = 0, refused = 0;
  {
    std::vector<std::jthread> jobs;
    for (int i = 0; i < 4; ++i) {
      jobs.emplace_back([&] {
        MemoryBudget::Job job(budget, nullptr);
        EXPECT_TRUE(job.take(250, "").ok());
        ++ready;
        while (ready < 4) std::this_thread::yield();
        refused += !job.take(250, "more").ok();
      });
    }
  }
  EXPECT_GE(refused, 1);
  EXPECT_LT(refused, 4) << "what one gives back is another's";
  EXPECT_EQ(budget.reserved(), 0u);
}

TEST_F(MemoryBudgetTest, HasAnEndOfItsPatience) {
  MemoryBudget hasty({.most = [] { return 1000; },
                      .held = [] { return 0; },
                      .make_room = [](std::uint64_t) {},
                      .patience = std::chrono::milliseconds(0)});
  MemoryBudget::Job first(hasty, nullptr), second(hasty, nullptr);
  ASSERT_TRUE(first.take(700, "").ok());
  EXPECT_EQ(second.take(400, "").code(), absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace curvecast::server
