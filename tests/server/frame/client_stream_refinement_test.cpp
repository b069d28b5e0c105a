// Better frames of a view, once the session beneath it has been improved.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/server/frame/conversation.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;
using ::testing::ElementsAre;

class StreamRefinement : public ::testing::Test, public Conversation {
 protected:
  void SetUp() override {
    short_ = true;
    receive(open_request("known"));
    receive(view_request(1));
    run_all();
    ASSERT_EQ(frames_.size(), 1u);
    EXPECT_TRUE(frames_[0].statistics().refining());
  }
  void publish() {
    ++revision_;
    stream_->refined(*session_);
    deliver();
  }
};

TEST_F(StreamRefinement, AnswersTheSameViewAgain) {
  short_ = false;
  publish();
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_EQ(frames_[1].curve_revision(), 2u);
  EXPECT_FALSE(frames_[1].statistics().refining());
  publish();  // for somebody else
  EXPECT_TRUE(jobs_.empty());
}

TEST_F(StreamRefinement, OtherSessionsAreNoNews) {
  stream_->refined(Session());
  EXPECT_TRUE(jobs_.empty());
}

TEST_F(StreamRefinement, ANewerViewTakesItsPlace) {
  receive(view_request(2));
  short_ = false;
  publish();
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 2));
}

TEST_F(StreamRefinement, AViewThatComesMeanwhileTakesItsPlace) {
  publish();
  ASSERT_EQ(jobs_.size(), 1u);
  receive(view_request(2));
  short_ = false;
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 2));
}

TEST_F(StreamRefinement, MayEndWhileAViewIsAnswered) {
  receive(ack_request(1));
  on_answer_ = [this] {
    on_answer_ = nullptr;
    stream_->refined(*session_);
  };
  receive(view_request(2));
  run_job();
  EXPECT_THAT(sequences(), ElementsAre(1, 2));
  ASSERT_EQ(jobs_.size(), 1u);  // again
  short_ = false;
  revision_ = 2;
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 2));
}

TEST_F(StreamRefinement, FramesOfOneViewCountOneByOne) {
  publish();
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 1));
  publish();
  EXPECT_TRUE(jobs_.empty()) << "two are unacknowledged";
  receive(ack_request(1));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 1, 1));
}

TEST_F(StreamRefinement, AnAcknowledgementMeansWhatWasSent) {
  receive(ack_request(1));
  slow_ = true;
  receive(view_request(2));
  run_all();  // on its way
  publish();
  run_all();  // waits behind it
  EXPECT_THAT(sequences(), ElementsAre(1, 2));
  receive(ack_request(2));  // the first of the two
  publish();
  run_all();
  publish();
  EXPECT_TRUE(jobs_.empty()) << "two are unacknowledged";
  slow_ = false;
  deliver();
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 2, 2));
}

TEST_F(StreamRefinement, NothingNewIsNotSent) {
  stream_->refined(*session_);  // the curve as it was
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1));
  short_ = false;  // and now the word that there will be none
  stream_->refined(*session_);
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_FALSE(frames_[1].statistics().refining());
}

TEST_F(StreamRefinement, MorePointsOfTheSameCurveAreNews) {
  for (const std::uint64_t shown : {100u, 100u, 400u, 400u}) {
    shown_ = shown;
    stream_->refined(*session_);
    run_all();
    receive(ack_request(1));
  }
  ASSERT_THAT(sequences(), ElementsAre(1, 1, 1));
  EXPECT_EQ(frames_[1].held_points(), 100u);
  EXPECT_EQ(frames_[2].held_points(), 400u);
}

TEST_F(StreamRefinement, ComesToAnEnd) {
  for (int i = 0; i < 100; ++i) {
    publish();
    run_all();
    receive(ack_request(1));
  }
  EXPECT_LT(frames_.size(), 20u);
  EXPECT_FALSE(frames_.back().statistics().refining());
}

TEST_F(StreamRefinement, WorkForOthersDoesNotCount) {
  for (int i = 0; i < 4; ++i) {
    stream_->refined(*session_);  // brings this view nothing
    run_all();
  }
  std::vector<std::uint64_t> revisions;
  for (int i = 0; i < 8; ++i) {
    publish();
    run_all();
    receive(ack_request(1));
    revisions.push_back(frames_.back().curve_revision());
  }
  EXPECT_THAT(revisions, ElementsAre(2, 3, 4, 5, 6, 7, 8, 9));
  EXPECT_FALSE(frames_.back().statistics().refining());
}

TEST_F(StreamRefinement, WorkThatBringsNothingComesToAnEnd) {
  for (int i = 0; i < 100; ++i) {
    stream_->refined(*session_);
    run_all();
  }
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_FALSE(frames_[1].statistics().refining());
}

TEST_F(StreamRefinement, IsNotWaitedForAfterTheClientsEnd) {
  stream_->half_close();
  deliver();
  ASSERT_TRUE(ended_);
  EXPECT_TRUE(ended_->ok());
  publish();
  EXPECT_TRUE(jobs_.empty());
}

TEST_F(StreamRefinement, AnOvertakenFramePromisesNothing) {
  receive(ack_request(1));
  receive(view_request(2));
  on_answer_ = [this] {
    on_answer_ = nullptr;
    stream_->receive(view_request(3));
  };
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 2, 3));
  EXPECT_FALSE(frames_[1].statistics().refining());
  EXPECT_TRUE(frames_[2].statistics().refining());
}

TEST_F(StreamRefinement, AFrameAfterTheClientsEndPromisesNothing) {
  receive(view_request(2));
  stream_->half_close();
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 2));
  EXPECT_FALSE(frames_[1].statistics().refining());
  EXPECT_TRUE(ended_);
}

TEST_F(StreamRefinement, AnErrorOfTheBetterFrameEndsThePromise) {
  fails_ = true;
  publish();
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_EQ(frames_[1].error().code(), static_cast<std::uint32_t>(Code::kResourceExhausted));
  publish();
  EXPECT_TRUE(jobs_.empty());
}

TEST_F(StreamRefinement, ABusyServerIsAskedAgainAtTheNextEvent) {
  busy_ = true;
  publish();
  busy_ = false;
  short_ = false;
  receive(ack_request(1));
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_FALSE(frames_[1].statistics().refining());
}

TEST_F(StreamRefinement, ABusyServerIsAskedAgainThoughNothingHappens) {
  busy_ = true;
  publish();
  stream_->retry();
  EXPECT_TRUE(jobs_.empty());
  busy_ = false;
  short_ = false;
  stream_->retry();
  stream_->retry();
  EXPECT_EQ(jobs_.size(), 1u);
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 1));
  stream_->retry();
  EXPECT_TRUE(jobs_.empty()) << "nothing is due";
}

TEST_F(StreamRefinement, ABusyServerLeavesTheFrameThatThereIs) {
  busy_ = true;
  publish();
  EXPECT_THAT(sequences(), ElementsAre(1));
  EXPECT_FALSE(ended_);
}

}  // namespace
}  // namespace curvecast::server
