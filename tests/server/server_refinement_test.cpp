// Curves that become finer while they are used, over TCP.
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "server_fixture.h"

#include "tests/server/eventually.h"
#include "tests/server/frame/frame_points.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kMadeFor = 500;
constexpr std::uint64_t kMany = 20'000;

/// Far more points than the session was made for, and on a part of the surface.
v1::SampleRequest greedy(std::uint64_t points = kMany) {
  v1::SampleRequest sample = view_of(points);
  v1::CurvatureDensity& curvature = *sample.add_density()->mutable_curvature();
  curvature.set_exponent(8);
  curvature.set_floor(0.01);
  return sample;
}

class ServerRefinement : public ServerFixture {
 protected:
  using Stream = grpc::ClientReaderWriterInterface<v1::StreamViewsRequest, v1::StreamViewsResponse>;

  void SetUp() override { open({}); }

  void open(const ServerOptions& options) {
    start(options);
    stub_ = client();
    const Created created = create(*stub_, upload(*stub_, sphere_off(4)), kMadeFor);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    session_id_ = created.session.session_id();
    first_size_ = created.session.report().curve_vertices();
    EXPECT_EQ(created.session.curve_revision(), 1u);
    EXPECT_FALSE(created.session.refining());
  }

  v1::Session session() {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSessionRequest request;
    request.set_session_id(session_id_);
    v1::GetSessionResponse response;
    EXPECT_TRUE(stub_->GetSession(&context, request, &response).ok());
    return response.session();
  }
  v1::Session wait_until_refined() {
    v1::Session now;
    EXPECT_TRUE(eventually([&] {
      now = session();
      return !now.refining();
    }));
    return now;
  }
  void close() {
    grpc::ClientContext context;
    v1::CloseSessionRequest request;
    request.set_session_id(session_id_);
    v1::CloseSessionResponse response;
    EXPECT_TRUE(stub_->CloseSession(&context, request, &response).ok());
  }

  void send_open(Stream& stream) const {
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(session_id_);
    stream.Write(request);
  }
  static void send_view(Stream& stream, std::uint64_t sequence, const v1::SampleRequest& sample) {
    v1::StreamViewsRequest request;
    request.mutable_view()->set_sequence(sequence);
    *request.mutable_view()->mutable_sample() = sample;
    stream.Write(request);
  }
  static void send_ack(Stream& stream, std::uint64_t sequence) {
    v1::StreamViewsRequest request;
    request.mutable_ack()->set_sequence(sequence);
    stream.Write(request);
  }
  /// The frames of view 1 until one says that there will be no better one.
  std::vector<v1::PointFrame> frames_of(Stream& stream) {
    std::vector<v1::PointFrame> frames;
    v1::StreamViewsResponse response;
    while (stream.Read(&response)) {
      frames.push_back(response.frame());
      send_ack(stream, response.frame().sequence());
      if (!frames.back().statistics().refining()) break;
    }
    return frames;
  }

  std::unique_ptr<Stub> stub_;
  std::string session_id_;
  std::uint64_t first_size_ = 0;
};

TEST_F(ServerRefinement, AStreamGetsABetterFrameByItself) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream);
  send_view(*stream, 1, greedy());
  const std::vector<v1::PointFrame> frames = frames_of(*stream);
  ASSERT_GE(frames.size(), 2u);
  EXPECT_EQ(frames.front().curve_revision(), 1u);
  EXPECT_EQ(frames.front().statistics().curve_vertices(), first_size_);
  EXPECT_TRUE(frames.front().statistics().refining());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].sequence(), 1u);
    EXPECT_FALSE(frames[i].has_error());
    EXPECT_EQ(count_points(frames[i]), kMany);
    EXPECT_GE(frames[i].curve_revision(), frames[i > 0 ? i - 1 : 0].curve_revision());
  }
  EXPECT_GT(frames.back().curve_revision(), 1u);
  EXPECT_GT(frames.back().statistics().curve_vertices(), first_size_);
  EXPECT_FALSE(frames.back().statistics().refining());
  // The session tells the same, and the same view is answered well at once from now on.
  const v1::Session now = wait_until_refined();
  EXPECT_EQ(now.curve_revision(), frames.back().curve_revision());
  EXPECT_EQ(now.report().curve_vertices(), frames.back().statistics().curve_vertices());
  EXPECT_GT(now.report().curve_bytes(), 0u);
  send_view(*stream, 2, greedy());
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.frame().sequence(), 2u);
  EXPECT_FALSE(response.frame().statistics().refining());
  EXPECT_EQ(point_bytes(response.frame()), point_bytes(frames.back()));
}

TEST_F(ServerRefinement, WhatTheCurveWasMadeForRefinesNothing) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream);
  v1::SampleRequest even;
  even.set_points(kMadeFor);
  send_view(*stream, 1, even);
  EXPECT_EQ(frames_of(*stream).size(), 1u);
  EXPECT_FALSE(session().refining());
  EXPECT_EQ(session().curve_revision(), 1u);
}

TEST_F(ServerRefinement, ResampleAnswersAtOnceAndTheNextCallIsBetter) {
  v1::SampleRequest sample;
  sample.set_points(kMany);
  const Resampled first = resample(*stub_, session_id_, sample);
  ASSERT_TRUE(first.status.ok()) << first.status.error_message();
  EXPECT_EQ(first.points(), kMany);
  EXPECT_TRUE(first.blocks.back().statistics().refining());
  const v1::Session refined = wait_until_refined();
  EXPECT_GT(refined.curve_revision(), 1u);
  const Resampled second = resample(*stub_, session_id_, sample);
  EXPECT_EQ(second.points(), kMany);
  EXPECT_FALSE(second.blocks.back().statistics().refining());
  EXPECT_GE(second.blocks.back().statistics().curve_vertices(), 10 * kMany);
}

TEST_F(ServerRefinement, StopsAtTheLimit) {
  ServerOptions options;
  options.max_curve_vertices = 30'000;
  open(options);
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream);
  send_view(*stream, 1, greedy(200'000));
  const std::vector<v1::PointFrame> frames = frames_of(*stream);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_GT(frames[1].statistics().curve_vertices(), first_size_);
  EXPECT_LE(frames[1].statistics().curve_vertices(), 30'000u);
  // No more is promised, however often it is asked for.
  for (int i = 0; i < 3; ++i) {
    const Resampled again = resample(*stub_, session_id_, greedy(200'000));
    ASSERT_TRUE(again.status.ok());
    EXPECT_FALSE(again.blocks.back().statistics().refining());
  }
}

TEST_F(ServerRefinement, MayBeTurnedOff) {
  ServerOptions options;
  options.max_curve_vertices = 0;
  open(options);
  const Resampled sample = resample(*stub_, session_id_, greedy());
  ASSERT_TRUE(sample.status.ok());
  EXPECT_FALSE(sample.blocks.back().statistics().refining());
  EXPECT_FALSE(session().refining());
}

TEST_F(ServerRefinement, EveryFrameIsOfOneRevision) {
  // Clients that ask for more and more, so that revisions change under them.
  std::mutex mutex;
  std::map<std::uint64_t, std::uint64_t> size_of_revision;
  const auto converse = [&](std::uint64_t client_number) {
    const auto stub = client();
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub->StreamViews(&context);
    send_open(*stream);
    std::uint64_t last_revision = 0;
    // At least until the first finer curve is there; a broken server runs out of patience.
    for (std::uint64_t i = 1; i <= 12 || last_revision < 2; ++i) {
      const std::uint64_t points = 700 * std::min<std::uint64_t>(i, 12) * client_number;
      send_view(*stream, i, greedy(points));
      v1::StreamViewsResponse response;
      do {
        ASSERT_TRUE(stream->Read(&response));
        const v1::PointFrame& frame = response.frame();
        ASSERT_FALSE(frame.has_error()) << frame.error().message();
        send_ack(*stream, frame.sequence());
        EXPECT_GE(frame.curve_revision(), last_revision);
        last_revision = frame.curve_revision();
        EXPECT_TRUE(frame.sequence() < i || count_points(frame) == points);
        const std::lock_guard lock(mutex);
        const auto [known, is_new] = size_of_revision.try_emplace(last_revision, frame.statistics().curve_vertices());
        EXPECT_EQ(known->second, frame.statistics().curve_vertices()) << "revision " << last_revision;
      } while (response.frame().sequence() < i);
    }
    stream->WritesDone();
    v1::StreamViewsResponse rest;
    while (stream->Read(&rest)) {
    }
    EXPECT_TRUE(stream->Finish().ok());
  };
  std::vector<std::thread> clients;
  for (std::uint64_t c = 1; c <= 6; ++c) clients.emplace_back(converse, c);
  for (std::thread& thread : clients) thread.join();
  EXPECT_GT(size_of_revision.size(), 1u);
  std::uint64_t last = 0;
  for (const auto& [revision, size] : size_of_revision) {
    EXPECT_GT(size, last);
    last = size;
  }
}

TEST_F(ServerRefinement, AClosedSessionsStreamsGoOnAsTheyAre) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream);
  send_view(*stream, 1, greedy(300'000));
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_TRUE(response.frame().statistics().refining());
  close();
  // The promise is kept: a better frame that was ready, or the word that there will be none.
  send_ack(*stream, 1);
  while (response.frame().statistics().refining()) {
    ASSERT_TRUE(stream->Read(&response));
    send_ack(*stream, 1);
  }
  send_view(*stream, 2, greedy(400'000));
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.frame().sequence(), 2u);
  EXPECT_FALSE(response.frame().statistics().refining());
}

TEST_F(ServerRefinement, ShutdownDoesNotWaitForIt) {
  v1::SampleRequest sample = greedy(4'000'000);
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  send_open(*stream);
  sample.set_points(500'000);
  send_view(*stream, 1, sample);
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_TRUE(response.frame().statistics().refining());
  server_->shutdown(std::chrono::milliseconds(0));
  while (stream->Read(&response)) {
  }
  EXPECT_EQ(stream->Finish().error_code(), grpc::UNAVAILABLE);
}

}  // namespace
}  // namespace curvecast::server
