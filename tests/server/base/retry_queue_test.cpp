#include "server/base/retry_queue.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <mutex>
#include <utility>
#include <vector>

#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Found = RetryQueue::Found;

class RetryQueueTest : public ::testing::Test {
 protected:
  absl::Status attempt(const std::string& id) {
    const std::lock_guard lock(mutex_);
    tried_.push_back(id);
    return result_;
  }
  /// `state`: of what is done.
  void put(const std::string& id, const std::string& state = "") {
    queue_.put(id, [this, id, state](const std::atomic<bool>& cancel) { return attempt_(id + state, cancel); });
  }
  void set_result(absl::Status result) {
    const std::lock_guard lock(mutex_);
    result_ = std::move(result);
  }
  std::vector<std::string> tried() {
    const std::lock_guard lock(mutex_);
    return tried_;
  }
  std::size_t tries() { return tried().size(); }

  std::mutex mutex_;
  absl::Status result_;
  std::vector<std::string> tried_, undone_, lost_;
  std::function<absl::Status(const std::string&, const std::atomic<bool>&)> attempt_ =
      [this](const std::string& id, const std::atomic<bool>& /*cancel*/) { return attempt(id); };
  RetryQueue queue_{{.undo = [this](const std::string& id) { undone_.push_back(id); },
                     .on_tried =
                         [this](const std::string& id, const absl::Status& /*status*/, bool is_lost) {
                           if (is_lost) lost_.push_back(id);
                         }},
                    std::chrono::milliseconds(1),
                    std::chrono::milliseconds(4)};
};

TEST_F(RetryQueueTest, DoesEachOnce) {
  for (const char* id : {"a", "b", "c"}) put(id);
  EXPECT_TRUE(eventually([&] { return queue_.size() == 0; }));
  EXPECT_THAT(tried(), ElementsAre("a", "b", "c"));
  EXPECT_FALSE(queue_.has("a"));
}

TEST_F(RetryQueueTest, TriesAgainUntilItSucceeds) {
  set_result(absl::ResourceExhaustedError("the disk is full"));
  for (int i = 0; i < 40; ++i) put(absl::StrCat("s", i));
  EXPECT_TRUE(eventually([&] { return tries() > 400; }));
  EXPECT_EQ(queue_.size(), 40u) << "however many wait";
  EXPECT_TRUE(queue_.has("s39"));
  set_result(absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return queue_.size() == 0; }));
  EXPECT_THAT(lost_, IsEmpty());
}

TEST_F(RetryQueueTest, TheNewestStateIsDone) {
  set_result(absl::ResourceExhaustedError("the disk is full"));
  put("a", "1");
  EXPECT_TRUE(eventually([&] { return tries() > 2; }));
  put("a", "2");
  EXPECT_TRUE(eventually([&] { return tried().back() == "a2"; }));
  EXPECT_EQ(queue_.size(), 1u);
}

TEST_F(RetryQueueTest, WhatNeverWillBeIsNotTriedAgain) {
  set_result(absl::DataLossError("damaged"));
  put("a");
  EXPECT_TRUE(eventually([&] { return queue_.size() == 0; }));
  queue_.stop();
  EXPECT_EQ(tries(), 1u);
  EXPECT_THAT(lost_, ElementsAre("a"));
}

TEST_F(RetryQueueTest, WhatIsWithdrawnIsUndone) {
  std::promise<void> begun, go_on;
  attempt_ = [&](const std::string&, const std::atomic<bool>& cancel) {
    begun.set_value();
    go_on.get_future().wait();
    EXPECT_TRUE(cancel);
    return absl::OkStatus();
  };
  put("a");
  begun.get_future().wait();
  put("b");
  EXPECT_EQ(queue_.size(), 2u);
  EXPECT_THAT(queue_.ids(), UnorderedElementsAre("a", "b"));
  EXPECT_EQ(queue_.withdraw("b"), Found::kWaiting);
  EXPECT_EQ(queue_.withdraw("b"), Found::kNothing);
  EXPECT_FALSE(queue_.is_withdrawn("a"));
  EXPECT_EQ(queue_.withdraw("a"), Found::kBeingTried);
  EXPECT_EQ(queue_.withdraw("a"), Found::kWithdrawn);
  EXPECT_TRUE(queue_.is_withdrawn("a"));
  go_on.set_value();
  queue_.wait_until_undone("a");
  EXPECT_FALSE(queue_.is_withdrawn("a"));
  queue_.stop();
  EXPECT_THAT(undone_, ElementsAre("a"));
}

TEST_F(RetryQueueTest, WhatIsLetGoIsTriedOnce) {
  std::promise<void> begun, go_on;
  std::atomic<int> tries = 0;
  attempt_ = [&](const std::string&, const std::atomic<bool>&) {
    if (++tries == 1) {
      begun.set_value();
      go_on.get_future().wait();
    }
    return absl::ResourceExhaustedError("the disk is full");
  };
  put("a");
  begun.get_future().wait();
  put("b");
  queue_.let_go("a");
  queue_.let_go("b");
  go_on.set_value();
  EXPECT_TRUE(eventually([&] { return queue_.size() == 0; }));
  put("c");
  EXPECT_TRUE(eventually([&] { return tries > 4; }));
  queue_.let_go("c");
  EXPECT_TRUE(eventually([&] { return queue_.size() == 0; })) << "it had been tried";
  queue_.stop();
  EXPECT_THAT(lost_, ElementsAre("a", "b", "c"));
}

TEST_F(RetryQueueTest, TriesOnceMoreAtTheEnd) {
  set_result(absl::ResourceExhaustedError("the disk is full"));
  put("a");
  EXPECT_TRUE(eventually([&] { return tries() > 0; }));
  set_result(absl::OkStatus());
  queue_.stop();
  EXPECT_EQ(queue_.size(), 0u);
  EXPECT_THAT(lost_, IsEmpty());
  put("b");
  EXPECT_EQ(queue_.size(), 0u) << "too late";
}

}  // namespace
}  // namespace curvecast::server
