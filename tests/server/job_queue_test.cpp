#include "server/job_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <vector>

namespace curvecast::server {
namespace {

TEST(JobQueue, RunsEveryAcceptedJobOnce) {
  std::vector<std::atomic<int>> runs(500);
  {
    JobQueue queue(3, runs.size());
    for (auto& count : runs) ASSERT_TRUE(queue.submit([&count] { ++count; }).ok());
  }
  for (const auto& count : runs) EXPECT_EQ(count, 1);
}

TEST(JobQueue, OneWorkerKeepsTheOrder) {
  std::vector<int> order;
  {
    JobQueue queue(1, 100);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(queue.submit([&order, i] { order.push_back(i); }).ok());
  }
  ASSERT_EQ(order.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(order[i], i);
}

TEST(JobQueue, RefusesWhenFullAndAfterStop) {
  JobQueue queue(1, 2);
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

TEST(JobQueue, WithdrawsOnlyWhatHasNotStarted) {
  JobQueue queue(1, 10);
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

}  // namespace
}  // namespace curvecast::server
