// Streams of views, over TCP.
#include <gmock/gmock.h>

#include <thread>

#include "server_fixture.h"

#include "tests/server/frame/frame_points.h"

namespace curvecast::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ServerViews : public ServerFixture {
 protected:
  using Stream = grpc::ClientReaderWriterInterface<v1::StreamViewsRequest, v1::StreamViewsResponse>;

  void SetUp() override {
    ServerFixture::SetUp();
    stub_ = client();
    const Created created = create(*stub_, upload(*stub_, sphere_off(4)), 5000);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    session_id_ = created.session.session_id();
  }

  static void send_open(Stream& stream, const std::string& id) {
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(id);
    stream.Write(request);
  }
  static void send_view(Stream& stream, std::uint64_t sequence, std::uint64_t points) {
    v1::StreamViewsRequest request;
    request.mutable_view()->set_sequence(sequence);
    *request.mutable_view()->mutable_sample() = view_of(points);
    stream.Write(request);
  }
  static void send_ack(Stream& stream, std::uint64_t sequence) {
    v1::StreamViewsRequest request;
    request.mutable_ack()->set_sequence(sequence);
    stream.Write(request);
  }
  // Streams `count` views, acknowledging each frame.
  void converse(Stub& stub, std::uint64_t count) {
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub.StreamViews(&context);
    send_open(*stream, session_id_);
    v1::StreamViewsResponse response;
    for (std::uint64_t i = 1; i <= count; ++i) {
      send_view(*stream, i, 100 * i);
      ASSERT_TRUE(stream->Read(&response));
      ASSERT_FALSE(response.frame().has_error()) << response.frame().error().message();
      EXPECT_EQ(response.frame().sequence(), i);
      EXPECT_EQ(response.frame().kind(), v1::FRAME_KIND_KEY);
      EXPECT_GE(response.frame().curve_revision(), 1u);
      EXPECT_EQ(count_points(response.frame()), 100 * i);
      EXPECT_FALSE(response.frame().points(0).draco().data().empty());
      send_ack(*stream, i);
    }
    stream->WritesDone();
    EXPECT_FALSE(stream->Read(&response));
    const grpc::Status status = stream->Finish();
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  std::unique_ptr<Stub> stub_;
  std::string session_id_;
};

TEST_F(ServerViews, AnswersTwoClientsAtOnce) {
  std::thread other([this] { converse(*client(), 20); });
  converse(*stub_, 20);
  other.join();
}

TEST_F(ServerViews, AFrameHoldsWhatResampleGives) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream, session_id_);
  send_view(*stream, 1, 1234);
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  const Resampled resampled = resample(*stub_, session_id_, view_of(1234));
  ASSERT_EQ(resampled.blocks.size(), 1u);
  EXPECT_EQ(point_bytes(response.frame()), resampled.bytes());
}

TEST_F(ServerViews, TheNewestViewWinsUnderFlood) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream, session_id_);
  constexpr std::uint64_t kViews = 1000;
  for (std::uint64_t i = 1; i <= kViews; ++i) send_view(*stream, i, 5000);
  v1::StreamViewsResponse response;
  std::uint64_t last = 0;
  int frames = 0;
  for (; last < kViews; ++frames) {
    ASSERT_TRUE(stream->Read(&response));
    EXPECT_GT(response.frame().sequence(), last);
    last = response.frame().sequence();
    if (frames == 1) send_ack(*stream, last);
  }
  // The acknowledgement comes after all views, so the third frame can only answer the last one.
  EXPECT_LE(frames, 3);
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(ServerViews, ARefusedViewDoesNotEndTheStream) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream, session_id_);
  v1::StreamViewsResponse response;
  const std::pair<std::uint64_t, grpc::StatusCode> refused[] = {{0, grpc::INVALID_ARGUMENT}, {4'000'001, grpc::OUT_OF_RANGE}};
  std::uint64_t sequence = 0;
  for (const auto& [points, code] : refused) {
    send_view(*stream, ++sequence, points);
    ASSERT_TRUE(stream->Read(&response));
    EXPECT_EQ(response.frame().sequence(), sequence);
    EXPECT_EQ(response.frame().error().code(), static_cast<std::uint32_t>(code)) << response.frame().error().message();
    EXPECT_TRUE(response.frame().points().empty());
    send_ack(*stream, sequence);
  }
  send_view(*stream, ++sequence, 5000);
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(count_points(response.frame()), 5000u);
}

TEST_F(ServerViews, UnknownSessionsEndTheStream) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream, "nonsense");
  v1::StreamViewsResponse response;
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_EQ(stream->Finish().error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerViews, ClosedSessionsStayWithTheirStreams) {
  grpc::ClientContext context, close_context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream, session_id_);
  send_view(*stream, 1, 10);
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  v1::CloseSessionRequest request;
  request.set_session_id(session_id_);
  v1::CloseSessionResponse closed;
  ASSERT_TRUE(stub_->CloseSession(&close_context, request, &closed).ok());
  send_view(*stream, 2, 10);
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(count_points(response.frame()), 10u);
}

TEST_F(ServerViews, ClientsMayVanishAtAnyMoment) {
  for (int i = 0; i < 40; ++i) {
    const auto stub = client();
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub->StreamViews(&context);
    v1::StreamViewsResponse response;
    if (i % 4 > 0) send_open(*stream, session_id_);
    if (i % 4 > 1) send_view(*stream, 1, 5000);
    if (i % 4 > 2) {
      ASSERT_TRUE(stream->Read(&response));
      send_view(*stream, 2, 5000);
    }
    context.TryCancel();
    EXPECT_EQ(stream->Finish().error_code(), grpc::CANCELLED);
  }
  converse(*stub_, 3);
}

TEST_F(ServerViews, ShutdownEndsStreamsAtOnce) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream, session_id_);
  send_view(*stream, 1, 5000);
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  const auto start = std::chrono::steady_clock::now();
  std::thread stopper([this] { server_->shutdown(std::chrono::seconds(100)); });
  while (stream->Read(&response)) {
  }
  const grpc::Status status = stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("shutting down"));
  stopper.join();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(50));
}

}  // namespace
}  // namespace curvecast::server
