#include "client/lib/view_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "tests/client/fake_connection.h"
#include "tests/client/fake_view_call.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::NiceMock;

class ViewStreamTest : public ::testing::Test {
 protected:
  ViewStreamTest() {
    ON_CALL(connection_, stream_views).WillByDefault([this](const v1::OpenView&, const std::stop_token&) {
      return std::make_unique<FakeViewCall>(server_);
    });
  }
  std::shared_ptr<FakeServer> server_ = std::make_shared<FakeServer>();
  NiceMock<FakeConnection> connection_;
};

TEST_F(ViewStreamTest, OpensNumbersViewsAndAcknowledgesFrames) {
  const auto stream = ViewStream::open(connection_, "session");
  EXPECT_EQ(*stream->send_view({}), 1U);
  EXPECT_EQ(*stream->send_view({}), 2U);
  EXPECT_TRUE(absl::IsInvalidArgument(stream->send_view({}, false, 2).status()));
  EXPECT_TRUE(server_->acks().empty());
  server_->push(key_frame(2, 50));
  const auto frame = stream->next_frame(seconds(60));
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(frame->sequence, 2U);
  EXPECT_EQ(frame->curve_revision, 3U);
  EXPECT_EQ(frame->points->positions, sphere_points(50).positions);
  EXPECT_EQ(frame->encoded_bytes, 50U * 28);
  EXPECT_EQ(frame->statistics.curve_vertices(), 99U);
  EXPECT_TRUE(frame->error.ok());
  EXPECT_THAT(server_->acks(), ::testing::ElementsAre(2));
  EXPECT_EQ(*stream->send_view({}, false, 9), 9U);
  EXPECT_EQ(*stream->send_view({}), 10U);
  EXPECT_TRUE(stream->close().ok());
  EXPECT_EQ(server_->requests.front().open().session_id(), "session");
}

TEST_F(ViewStreamTest, GivesRefusedViewsAndGoesOn) {
  const auto stream = ViewStream::open(connection_, "session");
  v1::PointFrame refused;
  refused.set_sequence(1);
  refused.mutable_error()->set_code(9);
  refused.mutable_error()->set_message("the density is zero everywhere");
  server_->push(refused);
  server_->push(key_frame(2, 5));
  const auto first = stream->next_frame(seconds(60));
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_EQ(first->error, absl::FailedPreconditionError("the density is zero everywhere"));
  EXPECT_EQ(first->points->size(), 0U);
  const auto second = stream->next_frame(seconds(60));
  ASSERT_TRUE(second.ok()) << second.status();
  EXPECT_EQ(second->points->size(), 5U);
}

TEST_F(ViewStreamTest, TimesOut) {
  const auto stream = ViewStream::open(connection_, "session");
  EXPECT_TRUE(absl::IsDeadlineExceeded(stream->next_frame(milliseconds(1)).status()));
}

TEST_F(ViewStreamTest, RefusesBrokenFrames) {
  const auto stream = ViewStream::open(connection_, "session");
  v1::PointFrame broken = key_frame(1, 5);
  broken.mutable_points(0)->set_count(6);
  server_->push(broken);
  v1::PointFrame unknown = key_frame(2, 5);
  unknown.set_kind(static_cast<v1::FrameKind>(17));
  server_->push(unknown);
  EXPECT_TRUE(absl::IsDataLoss(stream->next_frame(seconds(60)).status()));
  EXPECT_TRUE(absl::IsDataLoss(stream->next_frame(seconds(60)).status()));
}

TEST_F(ViewStreamTest, TellsHowTheServerEndedIt) {
  const auto stream = ViewStream::open(connection_, "session");
  server_->push(key_frame(1, 5));
  server_->end(absl::NotFoundError("unknown session"));
  EXPECT_TRUE(stream->next_frame(seconds(60)).ok()) << "what came before the end";
  EXPECT_EQ(stream->next_frame(seconds(60)).status(), absl::NotFoundError("unknown session"));
  EXPECT_EQ(stream->send_view({}).status(), absl::NotFoundError("unknown session"));
  EXPECT_EQ(stream->close(), absl::NotFoundError("unknown session"));
}

TEST_F(ViewStreamTest, ClosesOnceAndTakesNoMoreViews) {
  const auto stream = ViewStream::open(connection_, "session");
  EXPECT_TRUE(stream->close().ok());
  EXPECT_TRUE(stream->close().ok());
  EXPECT_FALSE(stream->send_view({}).ok());
  EXPECT_TRUE(absl::IsAborted(stream->next_frame(seconds(60)).status()));
}

TEST_F(ViewStreamTest, IsDestroyedWithFramesWaiting) {
  const auto stream = ViewStream::open(connection_, "session");
  for (std::uint64_t i = 1; i < 100; ++i) server_->push(key_frame(i, 5));
}

TEST_F(ViewStreamTest, WritesAndReadsFromTwoThreads) {
  const auto stream = ViewStream::open(connection_, "session");
  constexpr std::uint64_t kFrames = 200;
  std::thread sender([&] {
    for (std::uint64_t i = 1; i <= kFrames; ++i) {
      EXPECT_EQ(*stream->send_view({}), i);
      server_->push(key_frame(i, 3));
    }
  });
  for (std::uint64_t i = 1; i <= kFrames; ++i) {
    const auto frame = stream->next_frame(seconds(60));
    ASSERT_TRUE(frame.ok()) << frame.status();
    EXPECT_EQ(frame->sequence, i);
  }
  sender.join();
  EXPECT_EQ(server_->acks().size(), kFrames);
}

}  // namespace
}  // namespace curvecast::client
