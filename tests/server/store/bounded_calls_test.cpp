#include "server/store/bounded_calls.h"

#include <gmock/gmock.h>

#include <future>
#include <stdexcept>
#include <thread>

#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Code = absl::StatusCode;

TEST(BoundedCalls, GiveTheResult) {
  const BoundedCalls calls(std::chrono::minutes(1));
  EXPECT_TRUE(calls.run([](CallProgress&) { return absl::OkStatus(); }, nullptr).ok());
  EXPECT_EQ(calls.run([](CallProgress&) { return absl::NotFoundError("none"); }, nullptr), absl::NotFoundError("none"));
  EXPECT_EQ(calls.run([](CallProgress&) -> absl::Status { throw std::runtime_error("broken"); }, nullptr).code(),
            Code::kInternal);
}

TEST(BoundedCalls, OneThatGetsOnMayTakeLong) {
  const BoundedCalls calls(milliseconds(200));
  EXPECT_TRUE(calls
                  .run(
                      [](CallProgress& progress) {
                        for (int i = 0; i < 20; ++i) {
                          std::this_thread::sleep_for(milliseconds(20));
                          progress.step();
                        }
                        return absl::OkStatus();
                      },
                      nullptr)
                  .ok());
}

TEST(BoundedCalls, OneThatHangsIsGivenUp) {
  const BoundedCalls calls(milliseconds(30), 2);
  const auto go_on = std::make_shared<std::promise<void>>();
  const std::shared_future<void> released(go_on->get_future());
  const auto seen = std::make_shared<std::atomic<int>>(0);
  const auto hang = [released, seen](CallProgress& progress) {
    released.wait();
    if (progress.is_given_up()) ++*seen;
    return absl::OkStatus();
  };
  for (int i = 0; i < 2; ++i) EXPECT_EQ(calls.run(hang, nullptr).code(), Code::kUnavailable);
  const absl::Status refused = calls.run([](CallProgress&) { return absl::OkStatus(); }, nullptr);
  EXPECT_EQ(refused.code(), Code::kUnavailable) << "threads do not pile up";
  EXPECT_THAT(refused.message(), HasSubstr("hang"));
  go_on->set_value();
  EXPECT_TRUE(eventually([&] { return *seen == 2; }));
  EXPECT_TRUE(eventually([&] { return calls.run([](CallProgress&) { return absl::OkStatus(); }, nullptr).ok(); }));
}

TEST(BoundedCalls, OneThatIsCancelledIsNotWaitedFor) {
  const BoundedCalls calls(std::chrono::minutes(10));
  std::atomic<bool> cancel = false;
  const auto ended = std::make_shared<std::promise<void>>();
  std::thread soon([&] {
    std::this_thread::sleep_for(milliseconds(20));
    cancel = true;
  });
  EXPECT_EQ(calls
                .run(
                    [ended](CallProgress& progress) {
                      while (!progress.is_given_up()) std::this_thread::sleep_for(milliseconds(1));
                      ended->set_value();
                      return absl::OkStatus();
                    },
                    &cancel)
                .code(),
            Code::kCancelled);
  soon.join();
  ended->get_future().wait();
}

}  // namespace
}  // namespace curvecast::server
