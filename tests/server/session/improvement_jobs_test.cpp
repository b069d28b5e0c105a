#include "server/session/improvement_jobs.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/server/ball_session.h"
#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

using Wishes = std::set<std::string>;

/// Jobs whose first improvement waits until it is let go or cancelled.
class ImprovementJobsTest : public ::testing::Test {
 protected:
  Improvement improve(const Demands<std::string>& demands, const std::atomic<bool>& cancel) {
    const Wishes wishes(demands.begin(), demands.end());
    improved_.push_back(wishes);
    if (improved_.size() == 1) {
      begun_.set_value();
      EXPECT_TRUE(eventually([&] { return is_open_ || cancel; }));
    }
    return {.is_better = !cancel, .is_last = wishes.contains("the last")};
  }
  bool ask(const std::shared_ptr<const Session>& session, const std::string& wish) {
    return jobs_.request(session, ++source_, wish);
  }
  void wait_for_first() { ASSERT_EQ(begun_.get_future().wait_for(kPatience), std::future_status::ready); }

  const std::shared_ptr<const Session> session_ = std::make_shared<Session>();
  const std::shared_ptr<const Session> other_ = std::make_shared<Session>();
  Ends ends_;
  std::promise<void> begun_;
  std::atomic<bool> is_open_ = false;
  std::vector<Wishes> improved_;  // by the jobs' thread
  std::vector<bool> marks_;       // of session_
  std::uint64_t source_ = 0;
  ImprovementJobs<std::string> jobs_{{.improve = [this](const Session&, const Demands<std::string>& wishes,
                                                        const std::atomic<bool>& cancel) { return improve(wishes, cancel); },
                                      .on_done = ends_.counter(),
                                      .mark =
                                          [this](const Session& session, bool has_job) {
                                            if (session.revisions == session_->revisions) marks_.push_back(has_job);
                                          }}};
};

TEST_F(ImprovementJobsTest, WhatIsAskedMeanwhileIsMadeTogether) {
  ASSERT_TRUE(ask(session_, "a"));
  wait_for_first();
  EXPECT_TRUE(ask(session_, "b"));
  EXPECT_TRUE(ask(std::make_shared<const Session>(*session_), "c")) << "a copy is the same session";
  EXPECT_TRUE(ask(other_, "d"));
  is_open_ = true;
  ASSERT_TRUE(ends_.wait_for(3));
  jobs_.stop();
  EXPECT_EQ(improved_, (std::vector<Wishes>{{"a"}, {"b", "c"}, {"d"}}));
  EXPECT_EQ(marks_, (std::vector<bool>{true, false}));
}

TEST_F(ImprovementJobsTest, NothingFollowsTheLastImprovement) {
  ASSERT_TRUE(ask(session_, "the last"));
  wait_for_first();
  EXPECT_TRUE(ask(session_, "b"));
  is_open_ = true;
  ASSERT_TRUE(ends_.wait_for(1));
  EXPECT_TRUE(ask(other_, "c"));
  ASSERT_TRUE(ends_.wait_for(2));
  jobs_.stop();
  EXPECT_EQ(improved_, (std::vector<Wishes>{{"the last"}, {"c"}}));
}

TEST_F(ImprovementJobsTest, CancelsTheJobOfOneSession) {
  ASSERT_TRUE(ask(session_, "a"));
  wait_for_first();
  EXPECT_TRUE(ask(other_, "b"));
  jobs_.cancel(*session_);
  ASSERT_TRUE(ends_.wait_for(2));
  jobs_.cancel(*session_);  // has none any more
  jobs_.stop();
  EXPECT_EQ(improved_, (std::vector<Wishes>{{"a"}, {"b"}}));
}

TEST_F(ImprovementJobsTest, StopCancelsWhatWaitsAndTellsSo) {
  ASSERT_TRUE(ask(session_, "a"));
  wait_for_first();
  EXPECT_TRUE(ask(other_, "b"));
  jobs_.stop();
  EXPECT_TRUE(ends_.wait_for(2));
  EXPECT_EQ(improved_, (std::vector<Wishes>{{"a"}})) << "what is cancelled before its turn is not begun";
  EXPECT_EQ(marks_, (std::vector<bool>{true, false}));
  EXPECT_FALSE(ask(session_, "c"));
  jobs_.stop();
}

}  // namespace
}  // namespace curvecast::server
