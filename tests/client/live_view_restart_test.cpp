// A LiveView over TCP, and a real server that stops and comes back on the same port.
#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "client/lib/client.h"
#include "client/lib/live_view.h"
#include "client/lib/retry.h"
#include "server/server.h"
#include "tests/client/live_view_events.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::client {
namespace {

constexpr std::uint64_t kPoints = 3000;

class LiveViewRestart : public ::testing::Test {
 protected:
  void SetUp() override {
    start({});
    ASSERT_NE(server_, nullptr);
    connection_ = make_connection(tcp_channel(address_));
    client_ = std::make_unique<Client>(connection_);
    const std::string ball = testing::to_off(testing::icosphere(4));
    const absl::StatusOr<std::string> mesh = client_->upload_mesh("ball.off", ball);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    v1::SessionOptions options;
    options.set_max_points(kPoints);
    const absl::StatusOr<v1::Session> session = client_->create_session(*mesh, options);
    ASSERT_TRUE(session.ok()) << session.status();
    session_id_ = session->session_id();
  }

  /// The first one on any free port, later ones on the same.
  void start(server::ServerOptions options) {
    options.listen = address_;
    options.cache = cache_.path();
    options.log = false;
    auto started = server::Server::start(options);
    ASSERT_TRUE(started.ok()) << started.status();
    server_ = *std::move(started);
    address_ = absl::StrCat("127.0.0.1:", server_->port());
  }
  void stop() {
    server_->shutdown(std::chrono::seconds(0));
    server_.reset();
  }

  /// The ball from a place on a circle about it.
  static v1::SampleRequest sample_at(double degrees) {
    v1::SampleRequest sample;
    sample.set_points(kPoints);
    sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    sample.add_density()->mutable_view();
    v1::Camera& camera = *sample.add_cameras();
    camera.mutable_eye()->set_x(3 * std::sin(degrees * M_PI / 180));
    camera.mutable_eye()->set_z(3 * std::cos(degrees * M_PI / 180));
    camera.mutable_target();
    return sample;
  }

  /// The first frame of a view from `next_` on, with nothing better to follow; `first` gets the first of all from there on.
  Frame settled_frame(std::uint64_t sequence, Frame* first = nullptr) {
    while (true) {
      Frame frame = events_.frame(next_++);
      EXPECT_TRUE(frame.error.ok()) << frame.error;
      if (first != nullptr) *std::exchange(first, nullptr) = frame;
      if (HasFailure() || frame.points == nullptr) return frame;
      if (frame.sequence == sequence && !frame.statistics.refining()) return frame;
    }
  }

  void expect_at_once(const Frame& frame, const v1::SampleRequest& sample) {
    v1::ResampleRequest request;
    request.set_session_id(session_id_);
    *request.mutable_sample() = sample;
    const absl::StatusOr<DecodedSample> whole = client_->resample(request);
    ASSERT_TRUE(whole.ok()) << whole.status();
    ASSERT_NE(frame.points, nullptr);
    EXPECT_EQ(frame.points->positions, whole->points.positions);
    EXPECT_EQ(frame.points->normals, whole->points.normals);
    EXPECT_EQ(frame.points->ranks, whole->points.ranks);
  }

  testing::TemporaryFolder cache_;
  std::string address_ = "127.0.0.1:0";
  std::unique_ptr<server::Server> server_;
  std::shared_ptr<Connection> connection_;
  std::unique_ptr<Client> client_;
  std::string session_id_;
  LiveViewEvents events_;
  std::size_t next_ = 0;  // frame that settled_frame() has not seen
};

TEST_F(LiveViewRestart, WhoMovesOnHasNewPointsWhenTheServerIsBack) {
  LiveView view(connection_, session_id_, events_.callbacks());
  settled_frame(view.look(sample_at(0)));
  const Frame before = settled_frame(view.look(sample_at(1)));
  EXPECT_TRUE(before.is_delta);
  expect_at_once(before, sample_at(1));
  for (int restart = 1; restart <= 3; ++restart) {
    stop();
    const std::uint64_t number = view.look(sample_at(1 + restart));
    start({});
    Frame first;
    const Frame frame = settled_frame(number, &first);
    EXPECT_EQ(first.sequence, number);
    expect_at_once(frame, sample_at(1 + restart));
    EXPECT_EQ(events_.count(LiveViewState::kLive), 1U + restart);
  }
  EXPECT_EQ(events_.count(LiveViewState::kEnded), 0U);
}

// The new server does not have all of its points yet. Where it takes long to make them he gets what there is.
TEST_F(LiveViewRestart, WhoStandsStillKeepsHisPointsWhenTheServerIsBack) {
  LiveView view(connection_, session_id_, events_.callbacks());
  const std::uint64_t number = view.look(sample_at(0));
  const Frame before = settled_frame(number);
  for (std::uint64_t restart = 1; restart <= 3; ++restart) {
    stop();
    start({});
    Frame first;
    const Frame frame = settled_frame(number, &first);
    if (first.is_delta) {
      EXPECT_EQ(first.added, 0U);
    }
    EXPECT_EQ(frame.points->positions, before.points->positions);
    EXPECT_EQ(events_.count(LiveViewState::kLive), 1 + restart);
  }
  expect_at_once(before, sample_at(0));
}

TEST_F(LiveViewRestart, AClosedSessionEndsIt) {
  LiveView view(connection_, session_id_, events_.callbacks());
  settled_frame(view.look(sample_at(0)));
  ASSERT_TRUE(client_->close_session(session_id_).ok());
  EXPECT_TRUE(settled_frame(view.look(sample_at(1))).is_delta) << "streams that are open go on";
  stop();
  start({});
  std::size_t last = 0;
  while (events_.state(last).state != LiveViewState::kEnded) ++last;
  EXPECT_TRUE(absl::IsNotFound(events_.state(last).status)) << events_.state(last).status;
}

TEST_F(LiveViewRestart, WaitsForRoom) {
  stop();
  start({.max_streams = 1});
  auto first = std::make_unique<LiveView>(connection_, session_id_, events_.callbacks());
  settled_frame(first->look(sample_at(0)));
  LiveViewEvents later;
  LiveView second(connection_, session_id_, later.callbacks());
  second.look(sample_at(1));
  EXPECT_EQ(later.state(1).state, LiveViewState::kWaiting);
  EXPECT_TRUE(absl::IsResourceExhausted(later.state(1).status)) << later.state(1).status;
  EXPECT_EQ(retry_after(later.state(1).status), std::chrono::seconds(1));
  first.reset();
  EXPECT_EQ(later.frame(0).sequence, 1U);
}

TEST_F(LiveViewRestart, StopsWhileThereIsNoServer) {
  LiveView view(connection_, session_id_, events_.callbacks(),
                {.first_delay = std::chrono::hours(1), .longest_delay = std::chrono::hours(1)});
  settled_frame(view.look(sample_at(0)));
  stop();
  EXPECT_EQ(events_.state(2).state, LiveViewState::kWaiting);
  EXPECT_TRUE(absl::IsUnavailable(events_.state(2).status)) << events_.state(2).status;
}

}  // namespace
}  // namespace curvecast::client
