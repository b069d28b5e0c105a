#include "client/lib/live_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <future>
#include <memory>

#include "client/lib/retry.h"
#include "tests/client/fake_connection.h"
#include "tests/client/fake_view_call.h"
#include "tests/client/live_view_events.h"

namespace curvecast::client {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using ::testing::NiceMock;

constexpr LiveViewOptions kQuick{.first_delay = milliseconds(0), .longest_delay = milliseconds(0)};
constexpr LiveViewOptions kSlow{.first_delay = hours(1), .longest_delay = hours(1)};

v1::SampleRequest view_of(std::uint64_t points) {
  v1::SampleRequest sample;
  sample.set_points(points);
  return sample;
}

absl::Status with_retry_after(absl::Status status, milliseconds delay) {
  set_retry_after(status, delay);
  return status;
}

class LiveViewTest : public ::testing::Test {
 protected:
  LiveViewTest() {
    ON_CALL(*connection_, stream_views).WillByDefault([this](const v1::OpenView&, const std::stop_token& stop) {
      const std::lock_guard lock(mutex_);
      const std::shared_ptr<FakeServer> server = opened_ < servers_.size() ? servers_[opened_] : std::make_shared<FakeServer>();
      ++opened_;
      return std::make_unique<StoppableCall>(server, stop);
    });
  }

  /// As the connection has them: requesting stop cancels the call.
  class StoppableCall : public FakeViewCall {
   public:
    StoppableCall(const std::shared_ptr<FakeServer>& server, const std::stop_token& stop)
        : FakeViewCall(server), on_stop_(stop, [server] { server->end(absl::CancelledError("stopped")); }) {}

   private:
    std::stop_callback<std::function<void()>> on_stop_;
  };

  std::size_t opened() {
    const std::lock_guard lock(mutex_);
    return opened_;
  }

  std::mutex mutex_;
  std::size_t opened_ = 0;  // streams; under mutex_
  // The ends of the first streams, in their order.
  std::vector<std::shared_ptr<FakeServer>> servers_{std::make_shared<FakeServer>(), std::make_shared<FakeServer>()};
  std::shared_ptr<NiceMock<FakeConnection>> connection_ = std::make_shared<NiceMock<FakeConnection>>();
  LiveViewEvents events_;
};

TEST_F(LiveViewTest, ConnectsAtTheFirstLookAndTellsOfFrames) {
  LiveView view(connection_, "session", events_.callbacks());
  EXPECT_EQ(view.look(view_of(50)), 1U);
  EXPECT_EQ(events_.state(0).state, LiveViewState::kConnecting);
  EXPECT_EQ(servers_[0]->request(0).open().session_id(), "session");
  EXPECT_EQ(servers_[0]->request(1).view().sequence(), 1U);
  EXPECT_EQ(servers_[0]->request(1).view().sample().points(), 50U);
  servers_[0]->push(key_frame(1, 50));
  EXPECT_EQ(events_.frame(0).points->size(), 50U);
  EXPECT_EQ(events_.state(1).state, LiveViewState::kLive);
  servers_[0]->push(key_frame(1, 60));
  EXPECT_EQ(events_.frame(1).points->size(), 60U);
  EXPECT_EQ(events_.count(LiveViewState::kLive), 1U);
}

TEST_F(LiveViewTest, LookNeverBlocksAndTheNewestViewWins) {
  LiveView view(connection_, "session", events_.callbacks());
  view.look(view_of(1));
  servers_[0]->request(1);
  servers_[0]->stall(true);
  // The second may be on its way when the others come; these are overtaken, but for the last.
  for (std::uint64_t number = 2; number <= 100; ++number) EXPECT_EQ(view.look(view_of(number)), number);
  servers_[0]->stall(false);
  std::uint64_t sent = 1;
  for (std::size_t i = 2; sent < 100; ++i) {
    ASSERT_LE(i, 3U);
    sent = servers_[0]->request(i).view().sequence();
    EXPECT_EQ(servers_[0]->request(i).view().sample().points(), sent);
  }
}

TEST_F(LiveViewTest, GoesOnFromWhatItHoldsAndSendsTheNewestViewAgain) {
  LiveView view(connection_, "session", events_.callbacks(), kQuick);
  view.look(view_of(50));
  servers_[0]->request(1);
  view.look(view_of(51));
  servers_[0]->request(2);
  v1::PointFrame frame = key_frame(2, 50);
  frame.set_digest(77);
  servers_[0]->push(frame);
  EXPECT_EQ(events_.frame(0).sequence, 2U);
  servers_[0]->end(absl::UnavailableError("gone"));
  EXPECT_EQ(events_.state(2).state, LiveViewState::kWaiting);
  EXPECT_EQ(events_.state(2).status, absl::UnavailableError("gone"));
  EXPECT_EQ(events_.state(3).state, LiveViewState::kConnecting);
  const v1::HeldPoints held = servers_[1]->request(0).open().held();
  EXPECT_EQ(held.digest(), 77U);
  EXPECT_EQ(held.points(), 50U);
  EXPECT_EQ(held.sample().points(), 51U);
  EXPECT_EQ(servers_[1]->request(1).view().sequence(), 2U);
  EXPECT_EQ(servers_[1]->request(1).view().sample().points(), 51U);
  EXPECT_EQ(view.look(view_of(52)), 3U);
  EXPECT_EQ(servers_[1]->request(2).view().sequence(), 3U);
}

TEST_F(LiveViewTest, ABadFrameIsAReasonToBeginAnew) {
  LiveView view(connection_, "session", events_.callbacks(), kQuick);
  view.look(view_of(5));
  v1::PointFrame good = key_frame(1, 5), bad = key_frame(1, 5);
  good.set_digest(7);
  bad.mutable_points(0)->set_count(6);
  servers_[0]->request(1);
  servers_[0]->push(good);
  servers_[0]->push(bad);
  EXPECT_TRUE(absl::IsDataLoss(events_.state(2).status));
  EXPECT_EQ(servers_[1]->request(0).open().held().digest(), 0U);
  v1::PointFrame refused;
  refused.set_sequence(1);
  refused.mutable_error()->set_code(8);
  refused.mutable_error()->set_message("no room");
  refused.mutable_error()->set_retry_after(1.5);
  servers_[1]->request(1);
  servers_[1]->push(refused);
  const Frame frame = events_.frame(1);
  EXPECT_EQ(frame.error.message(), "no room");
  EXPECT_EQ(retry_after(frame.error), milliseconds(1500));
  EXPECT_EQ(frame.points->size(), 5U) << "those of the frame before, though of another stream";
  servers_[1]->push(key_frame(1, 8));
  EXPECT_EQ(events_.frame(2).removed, 5U);
}

TEST_F(LiveViewTest, AServerThatFailsAfterEachFirstFrameIsAskedLessAndLessOften) {
  constexpr std::size_t kStreams = 9;
  servers_.resize(kStreams);
  for (auto& server : servers_) server = std::make_shared<FakeServer>();
  const auto begin = std::chrono::steady_clock::now();
  LiveView view(connection_, "session", events_.callbacks(), {.first_delay = milliseconds(1), .longest_delay = hours(1)});
  view.look(view_of(5));
  for (const auto& server : servers_) {
    server->request(1);
    server->push(key_frame(1, 5));
    server->end(absl::UnavailableError("gone"));
  }
  // Each pause is at least half of 1, 2, 4 ... ms.
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(127));
}

TEST_F(LiveViewTest, WhatMayPassIsWaitedFor) {
  for (const absl::Status& status :
       {absl::UnavailableError("a"), absl::AbortedError("b"), absl::DeadlineExceededError("c"), absl::CancelledError("d"),
        absl::DataLossError("e"), absl::InternalError("Received RST_STREAM with error code 2"),
        with_retry_after(absl::ResourceExhaustedError("f"), milliseconds(1)), absl::OkStatus()}) {
    LiveViewEvents events;
    opened_ = 0;
    for (auto& server : servers_) server = std::make_shared<FakeServer>();
    servers_[0]->end(status);
    LiveView view(connection_, "session", events.callbacks(), kQuick);
    view.look(view_of(5));
    EXPECT_EQ(events.state(1).state, LiveViewState::kWaiting) << status;
    EXPECT_EQ(events.state(1).status.code(), status.ok() ? absl::StatusCode::kAborted : status.code());
    servers_[1]->request(1);
    servers_[1]->push(key_frame(1, 5));
    EXPECT_EQ(events.frame(0).points->size(), 5U);
  }
}

TEST_F(LiveViewTest, WhatStaysWrongEndsIt) {
  for (const absl::Status& status : {absl::NotFoundError("a"), absl::UnauthenticatedError("b"), absl::PermissionDeniedError("c"),
                                     absl::InvalidArgumentError("d"), absl::InternalError("e"), absl::ResourceExhaustedError("f"),
                                     absl::FailedPreconditionError("g")}) {
    LiveViewEvents events;
    opened_ = 0;
    servers_[0] = std::make_shared<FakeServer>();
    servers_[0]->end(status);
    LiveView view(connection_, "session", events.callbacks(), kQuick);
    view.look(view_of(5));
    EXPECT_EQ(events.state(1).state, LiveViewState::kEnded);
    EXPECT_EQ(events.state(1).status, status);
    EXPECT_EQ(view.look(view_of(6)), 2U) << "in vain, but harmless";
  }
}

TEST_F(LiveViewTest, WaitsAsLongAsTheServerAsks) {
  servers_[0]->end(with_retry_after(absl::ResourceExhaustedError("full"), hours(1)));
  LiveView view(connection_, "session", events_.callbacks(), kQuick);
  view.look(view_of(5));
  EXPECT_EQ(events_.state(1).state, LiveViewState::kWaiting);
  EXPECT_EQ(opened(), 1U);
}

TEST_F(LiveViewTest, StopsWhateverItDoes) {
  { const LiveView unused(connection_, "session", events_.callbacks()); }
  {
    LiveView waiting(connection_, "session", events_.callbacks(), kSlow);
    servers_[0]->end(absl::UnavailableError("gone"));
    waiting.look(view_of(5));
    EXPECT_EQ(events_.state(1).state, LiveViewState::kWaiting);
  }
  {
    LiveView sending(connection_, "session", events_.callbacks());
    sending.look(view_of(5));
    servers_[1]->request(1);
    servers_[1]->stall(true);
    sending.look(view_of(6));
    for (std::uint64_t i = 0; i < 100; ++i) servers_[1]->push(key_frame(1, 5));
  }
  LiveView opening(connection_, "session", events_.callbacks());
  opening.look(view_of(5));
}

TEST_F(LiveViewTest, CallbacksMayLookAndNoneComesAfterIt) {
  std::promise<void> called;
  bool over = false;
  {
    LiveView view(connection_, "session", {.on_frame = [&](const Frame& frame) {
                    EXPECT_FALSE(over);
                    EXPECT_EQ(view.look(view_of(9)), frame.sequence + 1);
                    if (frame.sequence == 1) called.set_value();
                  }});
    view.look(view_of(5));
    servers_[0]->request(1);
    servers_[0]->push(key_frame(1, 5));
    called.get_future().wait();
    EXPECT_EQ(servers_[0]->request(3).view().sample().points(), 9U) << "after open, the first view and its acknowledgement";
    servers_[0]->push(key_frame(2, 5));
  }
  over = true;
}

}  // namespace
}  // namespace curvecast::client
