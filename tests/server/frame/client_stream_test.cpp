#include "server/frame/client_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <thread>
#include <utility>
#include <vector>

#include "server/base/job_queue.h"
#include "tests/server/frame/conversation.h"
#include "tests/server/frame/frame_points.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ClientStreamTest : public ::testing::Test, public Conversation {};

TEST_F(ClientStreamTest, AnswersViews) {
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 20; ++i) {
    receive(view_request(i, i));
    run_job();
    ASSERT_EQ(frames_.size(), i);
    EXPECT_EQ(frames_.back().sequence(), i);
    EXPECT_EQ(count_points(frames_.back()), i);
    receive(ack_request(i));
  }
  EXPECT_FALSE(ended_);
}

TEST_F(ClientStreamTest, TheNewestViewWins) {
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 500; ++i) receive(view_request(i));
  ASSERT_EQ(jobs_.size(), 1u);
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(500)) << "also of those that wait for a worker";
  on_answer_ = [this] {
    on_answer_ = nullptr;
    for (std::uint64_t i = 502; i <= 600; ++i) stream_->receive(view_request(i));
  };
  receive(view_request(501));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(500, 501)) << "the third is not made before one is acknowledged";
  receive(ack_request(501));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(500, 501, 600));
}

TEST_F(ClientStreamTest, NoNumberOfPointsIsExpectedToTakeLittle) {
  receive(open_request("known"));
  receive(view_request(1, kMaxPoints));
  run_all();
  const auto most = expected_;
  EXPECT_GT(most, std::chrono::nanoseconds(0));
  std::uint64_t sequence = 1;
  for (const std::uint64_t points : {kMaxPoints + 1, std::uint64_t{1} << 32, std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
    receive(ack_request(sequence));
    receive(view_request(++sequence, points));
    EXPECT_GE(expected_, most) << points;
    run_all();
  }
}

TEST_F(ClientStreamTest, WhoHasGoneIsNotAnswered) {
  receive(open_request("known"));
  receive(view_request(1));
  stream_->stop(absl::CancelledError("the client has gone"));
  on_answer_ = [] { FAIL() << "work for nobody"; };
  run_all();
  EXPECT_TRUE(ended_);
}

TEST_F(ClientStreamTest, AFrameInTheMakingHearsThatItIsNotWanted) {
  receive(open_request("known"));
  receive(view_request(1));
  on_answer_ = [this] {
    EXPECT_FALSE(context_.cancelled());
    stream_->stop(absl::CancelledError("the client has gone"));
    EXPECT_TRUE(context_.cancelled());
  };
  run_all();
  EXPECT_TRUE(frames_.empty());
}

TEST_F(ClientStreamTest, ANewerViewLeavesTheOlderOneLittleTime) {
  receive(open_request("known"));
  receive(view_request(1));
  on_answer_ = [this] {
    if (is_answered_) return;
    is_answered_ = true;
    EXPECT_FALSE(context_.limit->is_spent());
    stream_->receive(view_request(2));
    EXPECT_FALSE(context_.limit->is_spent()) << "a view that costs little is finished";
    context_.limit->spend(std::chrono::milliseconds(200));
    EXPECT_TRUE(context_.limit->is_spent());
  };
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(2)) << "nobody wants to know that the older one took too long";
}

TEST_F(ClientStreamTest, WhoMovesOnAllTheTimeSeesEverySecondView) {
  receive(open_request("known"));
  std::uint64_t sent = 0;
  receive(view_request(++sent));
  on_answer_ = [&] {
    if (sent < 8) stream_->receive(view_request(++sent));
    context_.limit->spend(std::chrono::milliseconds(200));
  };
  while (!jobs_.empty()) {
    run_job();
    if (!frames_.empty()) receive(ack_request(frames_.back().sequence()));
  }
  EXPECT_THAT(sequences(), ElementsAre(2, 4, 6, 8));
}

TEST_F(ClientStreamTest, AtMostTwoFramesAreUnacknowledged) {
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 10; ++i) {
    receive(view_request(i));
    run_all();
  }
  EXPECT_THAT(sequences(), ElementsAre(1, 2));
  receive(ack_request(1));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 10));
  receive(view_request(11));
  EXPECT_TRUE(jobs_.empty());
  receive(ack_request(10));  // and 2
  run_all();
  receive(view_request(12));
  run_all();
  receive(view_request(13));
  EXPECT_TRUE(jobs_.empty());
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 10, 11, 12));
}

TEST_F(ClientStreamTest, ARefusedViewGetsAnErrorAndTheStreamGoesOn) {
  receive(open_request("known"));
  receive(view_request(1, 0));  // refused on arrival
  ASSERT_EQ(frames_.size(), 1u);
  EXPECT_EQ(frames_[0].error().code(), static_cast<std::uint32_t>(Code::kInvalidArgument));
  EXPECT_THAT(frames_[0].error().message(), HasSubstr("sample.points"));
  receive(ack_request(1));
  receive(view_request(2, 99));  // refused by the sampler
  run_all();
  EXPECT_EQ(frames_.at(1).error().code(), static_cast<std::uint32_t>(Code::kOutOfRange));
  EXPECT_EQ(frames_.at(1).sequence(), 2u);
  receive(ack_request(2));
  receive(view_request(3, 98));  // an exception
  run_all();
  EXPECT_EQ(frames_.at(2).error().code(), static_cast<std::uint32_t>(Code::kInternal));
  receive(ack_request(3));
  busy_ = true;
  receive(view_request(4));  // no worker has time
  EXPECT_EQ(frames_.at(3).error().code(), static_cast<std::uint32_t>(Code::kResourceExhausted));
  receive(ack_request(4));
  busy_ = false;
  receive(view_request(5));
  run_all();
  EXPECT_FALSE(frames_.at(4).has_error());
  EXPECT_FALSE(ended_);
}

TEST_F(ClientStreamTest, ErrorsCountAsFrames) {
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 10; ++i) receive(view_request(i, 0));
  EXPECT_THAT(sequences(), ElementsAre(1, 2));
  receive(ack_request(2));
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 10));
}

TEST_F(ClientStreamTest, UnknownSessionEndsTheStream) {
  receive(open_request("unknown"));
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), Code::kNotFound);
  receive(view_request(1));  // too late, and harmless
  EXPECT_TRUE(jobs_.empty());
}

TEST_F(ClientStreamTest, BreachesOfTheProtocolEndTheStream) {
  const std::vector<std::vector<v1::StreamViewsRequest>> breaches = {
      {view_request(1)},
      {ack_request(1)},
      {v1::StreamViewsRequest()},
      {open_request("known"), open_request("known")},
      {open_request("known"), ack_request(0)},
      {open_request("known"), view_request(5), view_request(5)},
      {open_request("known"), view_request(5), ack_request(5)},  // not sent yet
      {open_request("known"), v1::StreamViewsRequest()},
  };
  for (const auto& breach : breaches) {
    Conversation fresh;
    for (const auto& request : breach) fresh.receive(request);
    ASSERT_TRUE(fresh.ended_) << breach.back().DebugString();
    EXPECT_EQ(fresh.ended_->code(), Code::kInvalidArgument) << breach.back().DebugString();
  }
}

TEST_F(ClientStreamTest, NothingIsSentAfterStop) {
  receive(open_request("known"));
  receive(view_request(1));
  receive(view_request(2));
  stream_->stop(absl::UnavailableError("going"));
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), Code::kUnavailable);
  run_all();
  EXPECT_TRUE(frames_.empty());
}

TEST_F(ClientStreamTest, RetiresAfterTheFrameUnderWay) {
  receive(open_request("known"));
  receive(view_request(1));
  on_answer_ = [this] {
    on_answer_ = nullptr;
    stream_->receive(view_request(2));
    stream_->retire(absl::UnavailableError("going"));
    EXPECT_FALSE(ended_);
  };
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1)) << "the client asks another server for the rest";
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), Code::kUnavailable);
}

TEST_F(ClientStreamTest, RetiresAtOnceWhereNothingIsUnderWay) {
  receive(open_request("known"));
  receive(view_request(1));
  run_all();
  EXPECT_FALSE(ended_);
  stream_->retire(absl::UnavailableError("going"));
  EXPECT_TRUE(ended_);
  receive(view_request(2));
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1));
}

TEST_F(ClientStreamTest, StopWaitsForTheMessageOnItsWay) {
  slow_ = true;
  receive(open_request("known"));
  receive(view_request(1));
  run_all();
  stream_->stop(absl::UnavailableError("going"));
  EXPECT_FALSE(ended_);
  sending_ = false;
  stream_->sent(true);
  EXPECT_TRUE(ended_);
}

TEST_F(ClientStreamTest, AFailedSendEndsTheStream) {
  slow_ = true;
  receive(open_request("known"));
  receive(view_request(1));
  run_all();
  sending_ = false;
  stream_->sent(false);
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), Code::kCancelled);
}

TEST_F(ClientStreamTest, FramesPileUpForNobody) {
  // Takes nothing in but acknowledges all that it may.
  slow_ = true;
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 100; ++i) {
    receive(view_request(i));
    run_all();
    if (!frames_.empty()) receive(ack_request(frames_.back().sequence()));
  }
  slow_ = false;
  deliver();
  EXPECT_LE(frames_.size(), 3u);
}

TEST_F(ClientStreamTest, HalfCloseAnswersWhatIsDueThenEnds) {
  receive(open_request("known"));
  for (std::uint64_t i = 1; i <= 3; ++i) {
    receive(view_request(i));
    if (i < 3) run_all();
  }
  stream_->half_close();
  deliver();
  EXPECT_FALSE(ended_);
  run_all();
  EXPECT_THAT(sequences(), ElementsAre(1, 2, 3));
  ASSERT_TRUE(ended_);
  EXPECT_TRUE(ended_->ok());
}

TEST_F(ClientStreamTest, HalfCloseBeforeOpenIsAnError) {
  stream_->half_close();
  ASSERT_TRUE(ended_);
  EXPECT_EQ(ended_->code(), Code::kInvalidArgument);
}

// A transport with a thread of its own, workers, a client that floods, and a stop out of the blue.
class ThreadedTransport final : public ClientStream::Transport {
 public:
  void send(v1::StreamViewsResponse response) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(ended_ || pending_);
    EXPECT_GT(response.frame().sequence(), last_);
    last_ = response.frame().sequence();
    pending_ = true;
    changed_.notify_all();
  }
  void end(const absl::Status&) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(ended_ || pending_);
    ended_ = true;
    changed_.notify_all();
  }
  void deliver(ClientStream& stream) {
    std::unique_lock lock(mutex_);
    while (!ended_) {
      changed_.wait(lock, [&] { return ended_ || pending_; });
      if (!pending_) break;
      pending_ = false;
      const std::uint64_t sequence = last_;
      lock.unlock();
      stream.sent(true);
      stream.receive(ack_request(sequence));
      lock.lock();
    }
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool pending_ = false, ended_ = false;
  std::uint64_t last_ = 0;
};

TEST(ClientStreamThreads, SurvivesAnyInterleaving) {
  for (int round = 0; round < 50; ++round) {
    ThreadedTransport transport;
    std::atomic<std::int64_t> queued = 0;
    JobQueue queue({.workers = 2, .max_waiting = 100});
    auto stream = std::make_shared<ClientStream>(
        &transport,
        ClientStream::Hooks{
            .find = [](const std::string&) -> absl::StatusOr<std::shared_ptr<const Session>> {
              return std::make_shared<const Session>();
            },
            .answer = [](const auto&, const FrameRequest&) { return absl::StatusOr<Answer>(Answer()); },
            .restore = [](const auto&, const auto&,
                          const auto&) { return absl::StatusOr<std::shared_ptr<const ReferenceFrame>>(nullptr); },
            .has_room = [] { return absl::OkStatus(); },
            .submit = [&](std::function<void()> job, std::chrono::nanoseconds) { return queue.submit(std::move(job)).status(); },
            .count_queued = [&](std::int64_t bytes) { queued += bytes; },
        });
    stream->receive(open_request("any"));
    std::thread sender([&] { transport.deliver(*stream); });
    std::thread client([&] {
      for (std::uint64_t i = 1; i <= 200; ++i) stream->receive(view_request(i));
      if (round % 2 == 0) stream->half_close();
    });
    std::thread stopper([&] {
      if (round % 2 != 0) stream->stop(absl::UnavailableError("going"));
    });
    client.join();
    stopper.join();
    sender.join();
    queue.stop();
    stream.reset();
    EXPECT_EQ(queued, 0);
  }
}

}  // namespace
}  // namespace curvecast::server
