#include "server/session/session_waiters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr auto kPatience = std::chrono::seconds(60);  // only what is broken waits that long

/// Notes its calls, each as "STAGE PERCENT" or the status of the end.
class Notes final : public SessionWaiter {
 public:
  void on_progress(std::string_view stage, double fraction) override {
    calls.push_back(std::string(stage) + " " + std::to_string(static_cast<int>(100 * fraction)));
    if (on_call) std::exchange(on_call, nullptr)();
  }
  void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) override {
    calls.push_back(absl::StatusCodeToString(session.status().code()));
    if (session.ok()) uses = session->use_count();
  }

  std::vector<std::string> calls;
  std::function<void()> on_call;  // within the next on_progress
  long uses = 0;                  // references to the session when this one had it
};

TEST(SessionWaiters, CallsOnlyWhereTheyAreDelivered) {
  SessionWaiters waiters;
  Notes notes;
  waiters.add(&notes);
  waiters.progress("read", 0);
  waiters.finish(absl::AbortedError("closed"));
  EXPECT_THAT(notes.calls, IsEmpty());
  waiters.deliver();
  EXPECT_THAT(notes.calls, ElementsAre("queued 0", "queued 100", "read 0", "ABORTED"));
}

TEST(SessionWaiters, WhoComesLateIsToldWhereItIs) {
  SessionWaiters waiters;
  Notes early, late;
  waiters.add(&early);
  waiters.progress("read", 0.5);
  waiters.add(&late);
  waiters.progress("read", 1);
  waiters.finish(std::make_shared<const Session>());
  waiters.deliver();
  EXPECT_THAT(early.calls, ElementsAre("queued 0", "queued 100", "read 50", "read 100", "OK"));
  EXPECT_THAT(late.calls, ElementsAre("read 50", "read 100", "OK"));
  EXPECT_TRUE(waiters.empty());
}

TEST(SessionWaiters, TheLastStageEndsWithSuccess) {
  SessionWaiters waiters;
  Notes notes;
  waiters.add(&notes);
  waiters.progress("map", 0);
  waiters.finish(std::make_shared<const Session>());
  waiters.progress("map", 0.7);  // too late
  waiters.deliver();
  EXPECT_THAT(notes.calls, ElementsAre("queued 0", "queued 100", "map 0", "map 100", "OK"));
  EXPECT_EQ(notes.uses, 1) << "its own reference is the only one";
}

TEST(SessionWaiters, DoesNotTellEveryLittleStep) {
  const auto start = std::chrono::steady_clock::now();
  SessionWaiters waiters;
  Notes notes;
  waiters.add(&notes);
  for (int i = 0; i < 1000; ++i) waiters.progress("map", i / 1000.0);
  waiters.deliver();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  EXPECT_LE(static_cast<double>(notes.calls.size()), 4 + passed.count() * 20);
}

TEST(SessionWaiters, WhoHasLeftIsNotCalled) {
  SessionWaiters waiters;
  Notes first, second;
  waiters.add(&first);
  waiters.add(&second);
  EXPECT_TRUE(waiters.remove(&first));
  EXPECT_FALSE(waiters.remove(&first));
  waiters.finish(absl::AbortedError("closed"));
  waiters.deliver();
  EXPECT_THAT(first.calls, IsEmpty());
  EXPECT_THAT(second.calls, ElementsAre("queued 0", "ABORTED"));
  EXPECT_FALSE(waiters.remove(&second)) << "it was told of the end";
}

TEST(SessionWaiters, WhoLeavesWaitsForTheCallUnderWay) {
  SessionWaiters waiters;
  std::promise<void> called;
  std::atomic<bool> is_over = false;
  Notes notes;
  notes.on_call = [&] {
    called.set_value();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    is_over = true;
  };
  waiters.add(&notes);
  std::jthread delivering([&] { waiters.deliver(); });
  ASSERT_EQ(called.get_future().wait_for(kPatience), std::future_status::ready);
  EXPECT_TRUE(waiters.remove(&notes));
  EXPECT_TRUE(is_over);
}

TEST(SessionWaiters, OneThatIsBeingCalledDoesNotHoldUpOthers) {
  SessionWaiters waiters;
  std::promise<void> called, release;
  Notes slow, other;
  slow.on_call = [&] {
    called.set_value();
    EXPECT_EQ(release.get_future().wait_for(kPatience), std::future_status::ready);
  };
  waiters.add(&slow);
  std::jthread delivering([&] { waiters.deliver(); });
  ASSERT_EQ(called.get_future().wait_for(kPatience), std::future_status::ready);
  waiters.add(&other);
  waiters.progress("read", 0);
  waiters.deliver();
  EXPECT_THAT(other.calls, ElementsAre("queued 0", "queued 100", "read 0"));
  release.set_value();
  delivering.join();
  EXPECT_THAT(slow.calls, ElementsAre("queued 0", "queued 100", "read 0")) << "by the thread that was calling it";
}

}  // namespace
}  // namespace curvecast::server
