#include "server/base/job_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

TEST(JobQueue, RunsEveryAcceptedJobOnce) {
  std::vector<std::atomic<int>> runs(500);
  {
    JobQueue queue({.workers = 3, .max_waiting = runs.size()});
    for (auto& count : runs) ASSERT_TRUE(queue.submit([&count] { ++count; }).ok());
  }
  for (const auto& count : runs) EXPECT_EQ(count, 1);
}

TEST(JobQueue, OneWorkerKeepsTheOrder) {
  std::vector<int> order;
  {
    JobQueue queue({.max_waiting = 100});
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(queue.submit([&order, i] { order.push_back(i); }).ok());
  }
  ASSERT_EQ(order.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(order[i], i);
}

TEST(JobQueue, RefusesWhenFullAndAfterStop) {
  JobQueue queue({.max_waiting = 2});
  std::promise<void> started, gate;
  ASSERT_TRUE(queue
                  .submit([&] {
                    started.set_value();
                    gate.get_future().wait();
                  })
                  .ok());
  started.get_future().wait();
  EXPECT_TRUE(queue.submit([] {}).ok());
  EXPECT_TRUE(queue.submit([] {}).ok());
  EXPECT_EQ(queue.submit([] {}).status().code(), absl::StatusCode::kResourceExhausted);
  gate.set_value();
  queue.stop();
  EXPECT_EQ(queue.submit([] {}).status().code(), absl::StatusCode::kUnavailable);
}

TEST(JobQueue, TellsOnceOfAJobThatMayBeStuck) {
  std::atomic<JobQueue::Nanoseconds::rep> now = 0;
  JobQueue queue({.max_waiting = 10, .patience = std::chrono::seconds(60), .clock = [&] { return JobQueue::Nanoseconds(now); }});
  std::promise<void> started, gate;
  ASSERT_TRUE(queue
                  .submit(
                      [&] {
                        started.set_value();
                        gate.get_future().wait();
                      },
                      {.caller = "anna", .expected = std::chrono::seconds(5)})
                  .ok());
  started.get_future().wait();
  std::vector<std::string> told;
  const auto tell = [&](const std::string& caller, JobQueue::Nanoseconds time) {
    told.push_back(caller);
    EXPECT_EQ(time, JobQueue::Nanoseconds(now));
  };
  const auto pass = [&](std::chrono::seconds time) { now += JobQueue::Nanoseconds(time).count(); };
  pass(std::chrono::seconds(110));
  queue.tell_overdue(tell);
  EXPECT_EQ(queue.overdue(), 0u);
  pass(std::chrono::seconds(1));
  EXPECT_EQ(queue.overdue(), 1u);
  queue.tell_overdue(tell);
  pass(std::chrono::seconds(100));
  queue.tell_overdue(tell);
  EXPECT_EQ(told, std::vector<std::string>{"anna"});
  gate.set_value();
  EXPECT_TRUE(eventually([&] { return queue.overdue() == 0; }));
}

TEST(JobQueue, WithdrawsOnlyWhatHasNotStarted) {
  JobQueue queue({.max_waiting = 10});
  std::promise<void> started, gate;
  bool ran = false;
  const auto first = queue.submit([&] {
    started.set_value();
    gate.get_future().wait();
  });
  const auto second = queue.submit([&] { ran = true; });
  ASSERT_TRUE(first.ok() && second.ok());
  started.get_future().wait();
  EXPECT_FALSE(queue.withdraw(*first));
  EXPECT_TRUE(queue.withdraw(*second));
  EXPECT_FALSE(queue.withdraw(*second));
  gate.set_value();
  queue.stop();
  EXPECT_FALSE(ran);
}

/// One worker, which is held until all jobs are queued, and a clock that only jobs move.
class JobQueueTurns : public ::testing::Test {
 protected:
  using Nanoseconds = JobQueue::Nanoseconds;

  void SetUp() override {
    ASSERT_TRUE(queue_
                    .submit(
                        [this] {
                          started_.set_value();
                          gate_.get_future().wait();
                        },
                        "gate")
                    .ok());
    started_.get_future().wait();
  }
  /// A job of `whose` that takes a while.
  absl::Status add(const std::string& whose, int takes) { return add(whose, {.caller = whose}, takes); }
  absl::Status add(const std::string& letter, const JobQueue::Claim& claim, int takes) {
    return queue_
        .submit(
            [this, letter, takes] {
              order_ += letter;
              now_ += takes;
            },
            claim)
        .status();
  }
  /// A job of which is known how long it takes.
  absl::Status add_expected(const std::string& letter, const std::string& caller, int takes) {
    return add(letter, {.caller = caller, .expected = Nanoseconds(takes)}, takes);
  }
  std::string run() {
    gate_.set_value();
    EXPECT_TRUE(eventually([this] { return queue_.waiting() == 0; }));  // jobs may add others, which stop() refuses
    queue_.stop();
    return order_;
  }

  std::atomic<std::int64_t> now_ = 0;
  std::promise<void> started_, gate_;
  std::string order_;
  JobQueue queue_{{.max_waiting = 100, .max_waiting_of_one = 50, .clock = [this] { return Nanoseconds(now_.load()); }}};
};

TEST_F(JobQueueTurns, OneWithManyJobsDoesNotHoldUpOneWithFew) {
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(add("a", 10).ok());
  ASSERT_TRUE(add("b", 10).ok());
  EXPECT_EQ(run().substr(0, 4), "abaa");
}

TEST_F(JobQueueTurns, TheWorkersTimeIsShared) {
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(add("a", 30).ok());
  for (int i = 0; i < 12; ++i) ASSERT_TRUE(add("b", 10).ok());
  EXPECT_EQ(run(), "abbbabbbabbbabbb");
}

TEST_F(JobQueueTurns, ManyConnectionsOfACallerShareWhatItHas) {
  for (const char* connection : {"1", "2", "3"}) {
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(add(connection, {.caller = "many", .connection = connection}, 10).ok());
  }
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(add("b", 10).ok());
  EXPECT_EQ(run(), "1b2b3b1b23123123");
}

TEST_F(JobQueueTurns, AConnectionThatTakesMuchDoesNotHoldUpItsNeighbours) {
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(add("A", {.caller = "many", .connection = "greedy"}, 30).ok());
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(add("b", {.caller = "many", .connection = "modest"}, 10).ok());
  EXPECT_EQ(run(), "AbbbAbbbA");
}

TEST_F(JobQueueTurns, ShortJobsGoBeforeLongOnes) {
  ASSERT_TRUE(add_expected("L", "long", 1000).ok());
  ASSERT_TRUE(add_expected("M", "mixed", 500).ok());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(add_expected("s", "mixed", 1).ok());
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(add_expected("t", "short", 1).ok());
  EXPECT_EQ(run(), "stststststML");
}

TEST_F(JobQueueTurns, LongJobsDoNotStarve) {
  ASSERT_TRUE(add_expected("L", "a", 30).ok());
  // As soon as one is done there is another.
  std::promise<void> all_done;
  const std::function<void(int)> add_next = [&](int left) {
    const auto job = [&, left] {
      order_ += "s";
      now_ += 10;
      left > 1 ? add_next(left - 1) : all_done.set_value();
    };
    ASSERT_TRUE(queue_.submit(job, {.caller = "a", .expected = Nanoseconds(10)}).ok());
  };
  add_next(10);
  gate_.set_value();
  all_done.get_future().wait();
  queue_.stop();
  EXPECT_EQ(order_, "sssLsssssss");
}

TEST_F(JobQueueTurns, WhoComesLaterHasSavedNothingUp) {
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(add("a", 10).ok());
  ASSERT_TRUE(queue_
                  .submit(
                      [this] {
                        now_ += 10;
                        for (int i = 0; i < 3; ++i) EXPECT_TRUE(add("c", 10).ok());
                      },
                      "a")
                  .ok());
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(add("a", 10).ok());
  EXPECT_EQ(run(), "aacacac");
}

TEST_F(JobQueueTurns, OneMayNotFillTheQueue) {
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(add("a", 1).ok());
  EXPECT_EQ(add("a", 1).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(add("b", 1).ok());
  EXPECT_EQ(queue_.waiting(), 51u);
  EXPECT_EQ(run().size(), 51u);
}

TEST(JobQueue, ManyWhoComeOnceAreForgotten) {
  JobQueue queue({.workers = 2, .max_waiting = 10'000});
  std::atomic<int> runs = 0;
  for (int i = 0; i < 5'000; ++i) ASSERT_TRUE(queue.submit([&] { ++runs; }, std::to_string(i)).ok());
  queue.stop();
  EXPECT_EQ(runs, 5'000);
}

TEST(JobQueue, LongJobsLeaveAWorkerToShortOnes) {
  constexpr JobQueue::Nanoseconds kLong{1000}, kShort{1};
  JobQueue queue({.workers = 2, .max_waiting = 10, .long_job = kLong});
  std::promise<void> started, gate, all_short;
  std::atomic<int> long_ones = 0, short_ones = 0;
  std::atomic<bool> is_open = false, was_beside = false;
  ASSERT_TRUE(queue
                  .submit(
                      [&] {
                        started.set_value();
                        gate.get_future().wait();
                        is_open = true;
                      },
                      {.caller = "a", .expected = kLong})
                  .ok());
  started.get_future().wait();
  // Of whichever caller, also where they come first.
  for (const char* caller : {"a", "b"}) {
    const auto job = [&] {
      was_beside = was_beside || !is_open;
      ++long_ones;
    };
    ASSERT_TRUE(queue.submit(job, {.caller = caller, .expected = kLong}).ok());
  }
  for (const char* caller : {"a", "a", "b", "c"}) {
    const auto job = [&] {
      if (++short_ones == 4) all_short.set_value();
    };
    ASSERT_TRUE(queue.submit(job, {.caller = caller, .expected = kShort}).ok());
  }
  all_short.get_future().wait();
  EXPECT_EQ(long_ones, 0);
  gate.set_value();
  queue.stop();
  EXPECT_EQ(long_ones, 2);
  EXPECT_FALSE(was_beside);
}

TEST(JobQueue, OneDoesNotGetAllWorkers) {
  JobQueue queue({.workers = 2, .max_waiting = 10, .max_running_of_one = 1});
  std::promise<void> started, gate, other;
  ASSERT_TRUE(queue
                  .submit(
                      [&] {
                        started.set_value();
                        gate.get_future().wait();
                      },
                      "a")
                  .ok());
  started.get_future().wait();
  std::atomic<bool> second = false;
  ASSERT_TRUE(queue.submit([&] { second = true; }, "a").ok());
  ASSERT_TRUE(queue.submit([&] { other.set_value(); }, "b").ok());
  other.get_future().wait();
  EXPECT_FALSE(second);
  gate.set_value();
  queue.stop();
  EXPECT_TRUE(second);
}

}  // namespace
}  // namespace curvecast::server
