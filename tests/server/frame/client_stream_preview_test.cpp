// Streams on a coarse stand-in that gives way to the real session.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/server/frame/conversation.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;
using ::testing::ElementsAre;

class StreamPreview : public ::testing::Test, public Conversation {
 protected:
  void SetUp() override {
    auto preview = std::make_shared<Session>();
    preview->is_preview = true;
    session_ = preview;
    v1::StreamViewsRequest open = open_request("known");
    open.mutable_open()->set_accept_deltas(true);
    receive(open);
  }
  static v1::StreamViewsRequest ranked_view(std::uint64_t sequence) {
    v1::StreamViewsRequest request = view_request(sequence);
    request.mutable_view()->mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
    return request;
  }
  void replace(const absl::StatusOr<std::shared_ptr<const Session>>& real) {
    stream_->replace(*session_, real);
    deliver();
  }

  const std::shared_ptr<const Session> real_ = std::make_shared<const Session>();
};

TEST_F(StreamPreview, ItsFramesPromiseBetterOnes) {
  receive(ranked_view(1));
  run_all();
  ASSERT_EQ(frames_.size(), 1u);
  EXPECT_TRUE(frames_[0].statistics().refining());
  stream_->refined(*session_);  // of itself: nothing comes of it, and the promise stands
  run_all();
  EXPECT_EQ(frames_.size(), 1u);
}

TEST_F(StreamPreview, GivesWayWithAKeyFrameOfTheNewestView) {
  receive(ranked_view(1));
  run_all();
  replace(real_);
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_EQ(given_.back(), nullptr);
  EXPECT_EQ(frames_[1].kind(), v1::FRAME_KIND_KEY);
  EXPECT_FALSE(frames_[1].statistics().refining());
  receive(ack_request(1));
  receive(ranked_view(2));
  run_all();
  EXPECT_EQ(frames_.back().kind(), v1::FRAME_KIND_DELTA);  // from the real session's frame
  EXPECT_EQ(given_.back(), references_[1].get());
}

TEST_F(StreamPreview, WhatIsMadeMeanwhileIsMadeAnew) {
  on_answer_ = [&] {
    on_answer_ = nullptr;
    stream_->replace(*session_, real_);
  };
  receive(ranked_view(1));
  run_all();
  ASSERT_THAT(sequences(), ElementsAre(1));
  EXPECT_EQ(given_.size(), 2u);
  EXPECT_FALSE(frames_[0].statistics().refining());
}

TEST_F(StreamPreview, ANewerViewGoesBeforeWhatIsMadeAnew) {
  on_answer_ = [&] {
    on_answer_ = nullptr;
    stream_->replace(*session_, real_);
    stream_->receive(ranked_view(2));
  };
  receive(ranked_view(1));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(2));
}

TEST_F(StreamPreview, EndsWhereThereIsNoSession) {
  receive(ranked_view(1));
  run_all();
  replace(absl::ResourceExhaustedError("no room"));
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), Code::kResourceExhausted);
}

TEST_F(StreamPreview, OthersAreNoNews) {
  receive(ranked_view(1));
  run_all();
  stream_->replace(Session(), real_);
  stream_->replace(Session(), absl::AbortedError("closed"));
  EXPECT_TRUE(jobs_.empty());
  EXPECT_FALSE(ended_);
}

}  // namespace
}  // namespace curvecast::server
