#include "server/view_workers.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <future>
#include <string>

namespace curvecast::server {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBurst = std::chrono::duration_cast<milliseconds>(ViewWorkers::kBurst);

class ViewWorkersTest : public ::testing::Test {
 protected:
  /// Runs a job that takes so long, to its end.
  void run(const std::string& connection, milliseconds takes) {
    std::promise<void> done;
    ASSERT_TRUE(workers_
                    .submit(
                        [&] {
                          now_ += milliseconds(takes).count();
                          priority_ = getpriority(PRIO_PROCESS, 0);
                          done.set_value();
                        },
                        connection)
                    .ok());
    done.get_future().wait();
    settle();
  }
  /// Waits until the worker of normal priority has booked what it did.
  void settle() {
    std::promise<void> done;
    // Of somebody new: the clock may go on before its own time has been booked.
    ASSERT_TRUE(workers_.submit([&] { done.set_value(); }, "settle " + std::to_string(++settled_)).ok());
    done.get_future().wait();
  }

  std::atomic<std::int64_t> now_ = 0;  // ms
  std::atomic<int> priority_ = 0;
  int settled_ = 0;
  ViewWorkers workers_{
      {.workers = 1, .max_waiting = 100, .max_waiting_of_one = 50, .clock = [this] { return milliseconds(now_.load()); }}};
};

TEST_F(ViewWorkersTest, WhoTakesMoreThanItsShareWorksAtLowPriority) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  run("greedy", kBurst + milliseconds(100));
  EXPECT_EQ(priority_, normal);
  run("greedy", milliseconds(1));
  EXPECT_GT(priority_, normal);
  run("modest", milliseconds(1));
  EXPECT_EQ(priority_, normal);
}

TEST_F(ViewWorkersTest, WhatIsOwedIsForgivenWithTime) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  run("greedy", kBurst + milliseconds(100));
  now_ += 300;  // pays for 75
  run("greedy", milliseconds(0));
  EXPECT_GT(priority_, normal);
  now_ += 101;
  run("greedy", milliseconds(0));
  EXPECT_EQ(priority_, normal);
}

TEST_F(ViewWorkersTest, WhoStaysWithinItsShareIsServedAtOnceForEver) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  for (int i = 0; i < 1000; ++i) {
    run("steady", milliseconds(2));
    EXPECT_EQ(priority_, normal);
    now_ += 6;
  }
}

TEST_F(ViewWorkersTest, LongJobsOfOneDoNotHoldUpAnother) {
  run("greedy", kBurst + milliseconds(100));
  std::promise<void> started, gate, done;
  ASSERT_TRUE(workers_
                  .submit(
                      [&] {
                        started.set_value();
                        gate.get_future().wait();
                      },
                      "greedy")
                  .ok());
  started.get_future().wait();
  ASSERT_TRUE(workers_.submit([&] { done.set_value(); }, "modest").ok());
  done.get_future().wait();
  gate.set_value();
}

TEST_F(ViewWorkersTest, RunsAllThatWasTaken) {
  std::atomic<int> runs = 0;
  for (int i = 0; i < 90; ++i) {
    ASSERT_TRUE(workers_.submit([&] { ++runs; }, std::to_string(i)).ok());
  }
  workers_.stop();
  EXPECT_EQ(runs, 90);
  EXPECT_EQ(workers_.submit([] {}, "late").code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace curvecast::server
