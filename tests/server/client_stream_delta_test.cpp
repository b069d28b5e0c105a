#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/conversation.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;

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
  ASSERT_EQ(held_.size(), 6u);
  EXPECT_THAT(given_, ElementsAre(nullptr, held_[0].get(), held_[1].get(), held_[2].get(), nullptr, held_[4].get()));
  EXPECT_EQ(frames_[2].error().code(), static_cast<std::uint32_t>(absl::StatusCode::kOutOfRange));
}

TEST_F(ClientStreamDelta, WhoAsksForAKeyFrameGetsOne) {
  receive(delta_open());
  receive(ranked_request(1));
  run_all();
  receive(ranked_request(2));  // being answered
  v1::StreamViewsRequest key = ranked_request(3);
  key.mutable_view()->set_key_frame(true);
  receive(key);
  receive(ranked_request(4));  // overtakes it
  run_all();
  receive(ack_request(2));
  run_all();
  receive(ack_request(4));
  receive(ranked_request(5));
  run_all();
  EXPECT_THAT(given_, ElementsAre(nullptr, held_[0].get(), nullptr, held_[2].get()));
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

}  // namespace
}  // namespace curvecast::server
