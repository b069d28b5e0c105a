#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/server/frame/conversation.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ClientStreamDelta : public ::testing::Test, public Conversation {};

v1::StreamViewsRequest delta_open() {
  v1::StreamViewsRequest request = open_request("known");
  request.mutable_open()->set_accept_deltas(true);
  return request;
}

v1::StreamViewsRequest ranked_request(std::uint64_t sequence, std::uint64_t points = 10) {
  v1::StreamViewsRequest request = view_request(sequence, points);
  request.mutable_view()->mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
  return request;
}

TEST_F(ClientStreamDelta, DeltasStartFromTheFrameQueuedLast) {
  receive(delta_open());
  const auto answer = [&](const v1::StreamViewsRequest& view) {
    receive(view);
    run_all();
    receive(ack_request(view.view().sequence()));
  };
  answer(ranked_request(1));
  answer(ranked_request(2));
  answer(ranked_request(3, 99));  // refused: the client keeps what it has
  answer(ranked_request(4));
  answer(view_request(5));  // of the other sampler: nothing to start from
  answer(ranked_request(6));
  answer(ranked_request(7));
  ASSERT_EQ(references_.size(), 6u);
  EXPECT_THAT(given_, ElementsAre(nullptr, references_[0].get(), references_[1].get(), references_[2].get(), nullptr,
                                  references_[4].get()));
  EXPECT_EQ(frames_[2].error().code(), static_cast<std::uint32_t>(absl::StatusCode::kOutOfRange));
}

TEST_F(ClientStreamDelta, WhoAsksForAKeyFrameGetsOne) {
  receive(delta_open());
  receive(ranked_request(1));
  run_all();
  v1::StreamViewsRequest key = ranked_request(3);
  key.mutable_view()->set_key_frame(true);
  on_answer_ = [&] {
    on_answer_ = nullptr;
    stream_->receive(key);
    stream_->receive(ranked_request(4));  // overtakes it
  };
  receive(ranked_request(2));
  run_all();
  receive(ack_request(2));
  run_all();
  receive(ack_request(4));
  receive(ranked_request(5));
  run_all();
  EXPECT_THAT(given_, ElementsAre(nullptr, references_[0].get(), nullptr, references_[2].get()));
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 4, 5));
}

TEST_F(ClientStreamDelta, WhoDoesNotTakeDeltasGetsNone) {
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 3; ++i) {
    receive(ranked_request(i));
    run_all();
    receive(ack_request(i));
  }
  EXPECT_THAT(given_, ElementsAre(nullptr, nullptr, nullptr));
}

v1::StreamViewsRequest claiming_open(std::uint64_t digest) {
  v1::StreamViewsRequest request = delta_open();
  v1::HeldPoints& held = *request.mutable_open()->mutable_held();
  *held.mutable_sample() = ranked_request(1).view().sample();
  held.set_points(10);
  held.set_digest(digest);
  return request;
}

TEST_F(ClientStreamDelta, WhatAnotherStreamLeftIsBuiltUpon) {
  receive(claiming_open(kKnownDigest));
  for (std::uint64_t i = 1; i <= 3; ++i) {
    receive(ranked_request(i));
    run_all();
    receive(ack_request(i));
  }
  EXPECT_THAT(given_, ElementsAre(restored_.get(), references_[0].get(), references_[1].get()));
  EXPECT_THAT(claims_, ElementsAre(kKnownDigest)) << "made again once only";
}

TEST_F(ClientStreamDelta, WhoStandsStillKeepsWhatHeHasUntilItIsThere) {
  lacks_ = short_ = true;
  shown_ = 9;
  receive(claiming_open(kKnownDigest));
  receive(ranked_request(1));
  for (int i = 0; i < 3; ++i) {
    run_all();
    EXPECT_THAT(sequences(), IsEmpty()) << "nine points instead of ten";
    EXPECT_TRUE(jobs_.empty()) << "waits for the points";
    stream_->refined(*session_);
  }
  lacks_ = short_ = false;
  shown_ = 10;
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1));
  EXPECT_EQ(given_.back(), restored_.get());
}

TEST_F(ClientStreamDelta, NobodyKeepsWhatHeHasForEver) {
  hooks_.patience = std::chrono::milliseconds(50);
  stream_ = std::make_shared<ClientStream>(this, hooks_);
  lacks_ = short_ = true;
  shown_ = 9;
  receive(claiming_open(kKnownDigest));
  receive(ranked_request(1));
  run_all();
  std::this_thread::sleep_for(hooks_.patience);
  stream_->retry();
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1));
  EXPECT_TRUE(frames_.at(0).statistics().refining()) << "better ones follow as ever";
}

TEST_F(ClientStreamDelta, WhoHasMovedOnOrHasLessGetsAFrameAtOnce) {
  const auto frames = [](std::uint64_t there, std::uint64_t asked) {
    Conversation other;
    other.lacks_ = other.short_ = true;
    other.shown_ = there;
    other.receive(claiming_open(kKnownDigest));
    other.receive(ranked_request(1, asked));
    other.run_all();
    EXPECT_THAT(other.given_, ElementsAre(nullptr));
    return other.frames_.size();
  };
  EXPECT_EQ(frames(9, 10), 0u);
  EXPECT_EQ(frames(9, 11), 1u) << "another view";
  EXPECT_EQ(frames(10, 10), 1u) << "as many points";
}

TEST_F(ClientStreamDelta, AFalseClaimGetsAKeyFrame) {
  for (const std::uint64_t digest : {kKnownDigest + 1, std::uint64_t{98}}) {
    Conversation other;
    other.receive(claiming_open(digest));
    other.receive(ranked_request(1));
    other.run_all();
    if (digest == 98) {
      ASSERT_TRUE(other.frames_.at(0).has_error()) << "what is thrown is told";
    } else {
      EXPECT_THAT(other.given_, ElementsAre(nullptr));
    }
    EXPECT_FALSE(other.ended_);
  }
}

TEST_F(ClientStreamDelta, WhoAsksForAKeyFrameHasNoClaim) {
  receive(claiming_open(kKnownDigest));
  v1::StreamViewsRequest key = ranked_request(1);
  key.mutable_view()->set_key_frame(true);
  receive(key);
  run_all();
  EXPECT_THAT(given_, ElementsAre(nullptr));
  EXPECT_TRUE(claims_.empty());
}

TEST_F(ClientStreamDelta, AClaimThatMakesNoSenseEndsTheStream) {
  v1::StreamViewsRequest request = claiming_open(kKnownDigest);
  request.mutable_open()->mutable_held()->mutable_sample()->set_points(0);
  receive(request);
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), absl::StatusCode::kInvalidArgument);
}

v1::StreamViewsRequest request_in_parts(std::uint64_t sequence) {
  v1::StreamViewsRequest request = ranked_request(sequence);
  request.mutable_view()->set_first_bytes(2000);
  return request;
}

TEST_F(ClientStreamDelta, PartsFollowEachOtherAsTheyAreTakenIn) {
  receive(delta_open());
  parts_ = 3;
  receive(request_in_parts(1));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 1)) << "two are in flight";
  receive(ack_request(1));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 1, 1, 1));
  EXPECT_FALSE(frames_[3].statistics().refining());
  receive(ack_request(1));
  run_all();
  EXPECT_EQ(frames_.size(), 4u);
  EXPECT_THAT(given_, ElementsAre(nullptr, references_[0].get(), references_[1].get(), references_[2].get()));
}

TEST_F(ClientStreamDelta, APartWithoutProgressIsTheLast) {
  receive(delta_open());
  parts_ = 1000;
  stuck_ = true;
  shown_ = 50;
  receive(request_in_parts(1));
  for (int i = 0; i < 10; ++i) {
    run_all();
    receive(ack_request(1));
  }
  ASSERT_THAT(sequences(), ElementsAre(1, 1));
  EXPECT_TRUE(frames_[0].statistics().refining());
  EXPECT_FALSE(frames_[1].statistics().refining()) << "the promise is taken back";
}

TEST_F(ClientStreamDelta, PartsAreNoImprovements) {
  receive(delta_open());
  parts_ = 12;
  receive(request_in_parts(1));
  for (int i = 0; i < 20; ++i) {
    short_ = parts_ == 0;  // the whole lacks something
    run_all();
    receive(ack_request(1));
  }
  EXPECT_EQ(frames_.size(), 13u);
  EXPECT_TRUE(frames_.back().statistics().refining()) << "it may still be improved";
}

TEST_F(ClientStreamDelta, ANewerViewOvertakesParts) {
  receive(delta_open());
  parts_ = 1000;
  receive(request_in_parts(1));
  run_all();
  receive(request_in_parts(2));
  receive(ack_request(1));
  parts_ = 0;
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 1, 2));
  EXPECT_EQ(given_.back(), references_[1].get());
}

TEST_F(ClientStreamDelta, PartsAreForThoseWhoTakeDeltas) {
  receive(open_request("known"));
  parts_ = 3;
  receive(request_in_parts(1));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1));
  receive(ack_request(1));
  v1::StreamViewsRequest tiny = request_in_parts(2);
  tiny.mutable_view()->set_first_bytes(1);
  receive(tiny);
  EXPECT_EQ(frames_.back().error().code(), static_cast<std::uint32_t>(absl::StatusCode::kInvalidArgument));
}

TEST_F(ClientStreamDelta, AnAutomaticBudgetGrowsWhereFramesAreQuick) {
  receive(delta_open());
  std::uint64_t last = 0;
  for (std::uint64_t i = 1; i <= 10; ++i) {
    v1::StreamViewsRequest request = ranked_request(i);
    request.mutable_view()->mutable_sample()->mutable_automatic()->set_frame_seconds(10);
    receive(request);
    run_all();
    receive(ack_request(i));
    EXPECT_GT(frames_.back().points(0).count(), last);
    last = frames_.back().points(0).count();
  }
}

}  // namespace
}  // namespace curvecast::server
