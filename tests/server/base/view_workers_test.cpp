#include "server/base/view_workers.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

namespace curvecast::server {
namespace {

using std::chrono::milliseconds;

constexpr auto kPatience = std::chrono::seconds(60);  // only what is broken takes that long
constexpr milliseconds kBurst = std::chrono::duration_cast<milliseconds>(ViewWorkers::kBurst);

/// Of the patient workers, however low the process's own is; lower than 19 there is none.
int low(int normal) { return std::min(normal + 10, 19); }

class ViewWorkersTest : public ::testing::Test {
 protected:
  void submit(const std::string& connection, std::function<void()> job, const std::string& caller = "all",
              milliseconds expected = {}) {
    ASSERT_TRUE(workers_
                    .submit(
                        [this, job = std::move(job)] {
                          job();
                          const std::lock_guard lock(mutex_);
                          ++done_;
                          changed_.notify_all();
                        },
                        {.caller = caller, .connection = connection, .expected = expected})
                    .ok());
    ++submitted_;
  }
  void wait_until(const std::function<bool()>& condition) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, kPatience, condition)) << "a job did not run, or not to its end";
  }
  /// Runs a job that takes so long, to its end.
  void run(const std::string& connection, milliseconds takes, const std::string& caller = "all", milliseconds expected = {}) {
    submit(
        connection,
        [this, takes] {
          now_ += takes.count();
          priority_ = getpriority(PRIO_PROCESS, 0);
        },
        caller, expected);
    // And another one of the same caller, before which the worker of normal priority books what it did.
    wait_until([this] { return done_ == submitted_; });
    submit("nobody " + std::to_string(submitted_), [] {});
    wait_until([this] { return done_ == submitted_; });
  }

  std::atomic<std::int64_t> now_ = 0;  // ms
  std::atomic<int> priority_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  int done_ = 0, submitted_ = 0;
  ViewWorkers workers_{
      {.workers = 1, .max_waiting = 100, .max_waiting_of_one = 50, .clock = [this] { return milliseconds(now_.load()); }}};
};

TEST_F(ViewWorkersTest, WhoTakesMoreThanItsShareWorksAtLowPriority) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  run("greedy", kBurst + milliseconds(100));
  EXPECT_EQ(priority_, normal);
  run("greedy", milliseconds(1));
  EXPECT_EQ(priority_, low(normal));
  run("modest", milliseconds(1));
  EXPECT_EQ(priority_, normal);
}

TEST_F(ViewWorkersTest, WhatIsOwedIsForgivenWithTime) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  run("greedy", kBurst + milliseconds(100));
  now_ += 300;  // pays for 75
  run("greedy", milliseconds(0));
  EXPECT_EQ(priority_, low(normal));
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

TEST_F(ViewWorkersTest, WhoHasManyConnectionsHasNoMoreOfTheWorkersAtOnce) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  const milliseconds takes(20);
  for (int i = 0; i < 80; ++i) {
    run("new " + std::to_string(i), takes, "crowd", takes);
    // Half a worker's time, beyond what he had saved up: 500 ms, then 10 of each 20.
    EXPECT_EQ(priority_, i < 51 ? normal : low(normal)) << i;
  }
  run("frugal", milliseconds(1), "crowd", milliseconds(1));
  EXPECT_EQ(priority_, normal) << "short jobs hold up nobody";
  run("another's", takes, "another", takes);
  EXPECT_EQ(priority_, normal);
}

TEST_F(ViewWorkersTest, WhatWaitsIsPaidAlready) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  bool is_open = false;
  submit("first", [&] { wait_until([&] { return is_open; }); });
  std::atomic<int> lowered = 0;
  for (int i = 0; i < 40; ++i) {
    submit(
        "new " + std::to_string(i), [&] { lowered += getpriority(PRIO_PROCESS, 0) != normal ? 1 : 0; }, "all", milliseconds(20));
  }
  {
    const std::lock_guard lock(mutex_);
    is_open = true;
    changed_.notify_all();
  }
  wait_until([&] { return done_ == submitted_; });
  EXPECT_EQ(lowered, low(normal) == normal ? 0 : 14) << "500 ms pay for 26";
}

TEST_F(ViewWorkersTest, WhatTakesLongYieldsFromTheFirst) {
  const int normal = getpriority(PRIO_PROCESS, 0);
  const milliseconds takes = std::chrono::duration_cast<milliseconds>(ViewWorkers::kLong);
  run("first", takes, "all", takes);
  EXPECT_EQ(priority_, low(normal));
  run("second", takes, "all", takes - milliseconds(1));
  EXPECT_EQ(priority_, normal);
}

TEST_F(ViewWorkersTest, LongJobsOfOneDoNotHoldUpAnother) {
  run("greedy", kBurst + milliseconds(100));
  const int before = done_;
  bool is_open = false;
  submit("greedy", [&] { wait_until([&] { return is_open; }); });
  submit("modest", [] {});
  wait_until([&] { return done_ == before + 1; });
  {
    const std::lock_guard lock(mutex_);
    is_open = true;
    changed_.notify_all();
  }
  wait_until([&] { return done_ == before + 2; });
}

TEST_F(ViewWorkersTest, WhoHasManyConnectionsDoesNotHoldUpAnother) {
  bool is_open = false;
  for (int i = 0; i < 10; ++i) submit("new " + std::to_string(i), [&] { wait_until([&] { return is_open; }); });
  submit(
      "modest", [] {}, "another");
  wait_until([&] { return done_ == 1; });
  {
    const std::lock_guard lock(mutex_);
    is_open = true;
    changed_.notify_all();
  }
  wait_until([&] { return done_ == submitted_; });
}

TEST_F(ViewWorkersTest, RunsAllThatWasTaken) {
  std::atomic<int> runs = 0;
  for (int i = 0; i < 90; ++i) {
    ASSERT_TRUE(workers_.submit([&] { ++runs; }, {.caller = std::to_string(i % 2), .connection = std::to_string(i)}).ok());
  }
  workers_.stop();
  EXPECT_EQ(runs, 90);
  EXPECT_EQ(workers_.submit([] {}, {.connection = "late"}).code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace curvecast::server
