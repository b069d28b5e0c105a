// Deltas of a real server, over TCP: what a client holds that takes them in is what the server would give it at once.
#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "client/lib/client.h"
#include "client/lib/view_stream.h"
#include "server/server.h"
#include "tests/support/shapes.h"

namespace curvecast::client {
namespace {

using std::chrono::seconds;

constexpr seconds kPatience{120};

class ViewStreamDelta : public ::testing::Test {
 protected:
  void SetUp() override {
    auto started = server::Server::start({.listen = "127.0.0.1:0", .log = false});
    ASSERT_TRUE(started.ok()) << started.status();
    server_ = *std::move(started);
    connection_ = make_connection(tcp_channel(absl::StrCat("127.0.0.1:", server_->port())));
    client_ = std::make_unique<Client>(connection_);
    PolygonSoup ball = testing::icosphere(4);
    ball.attributes.scalars = {{"height", {}}};
    for (const Vec3d& p : ball.positions) ball.attributes.scalars[0].values.push_back(static_cast<float>(p.z()));
    const absl::StatusOr<std::string> mesh = client_->upload_mesh("ball.ply", testing::to_ply(ball));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    v1::SessionOptions options;
    options.set_max_points(4000);
    const absl::StatusOr<v1::Session> session = client_->create_session(*mesh, options);
    ASSERT_TRUE(session.ok()) << session.status();
    session_id_ = session->session_id();
    // The candidates that views lack are made now: else their first frames would be coarse.
    for (const double degrees : {0.0, 90.0, 180.0, 270.0}) {
      v1::ResampleRequest request;
      request.set_session_id(session_id_);
      *request.mutable_sample() = view(degrees, 1.2, 8000);
      ASSERT_TRUE(client_->resample(request).ok());
    }
  }

  /// The ball from a place on a circle about it. On one lattice, so that every frame has the same positions.
  static v1::SampleRequest view(double degrees, double distance, std::uint64_t points) {
    v1::SampleRequest sample;
    sample.set_points(points);
    sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    sample.mutable_encoding()->mutable_draco()->set_position_bits(11);
    sample.add_density()->mutable_view();
    const double angle = degrees * M_PI / 180;
    v1::Camera& camera = *sample.add_cameras();
    camera.mutable_eye()->set_x(distance * std::sin(angle));
    camera.mutable_eye()->set_y(0.3);
    camera.mutable_eye()->set_z(distance * std::cos(angle));
    camera.mutable_target();
    return sample;
  }

  using Place = std::array<double, 3>;

  /// The point that every view shows of which it is in the picture: that of the lowest rank.
  Place first_point() {
    v1::ResampleRequest request;
    request.set_session_id(session_id_);
    request.mutable_sample()->set_points(1);
    request.mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
    request.mutable_sample()->mutable_encoding()->mutable_raw();
    const absl::StatusOr<DecodedSample> sample = client_->resample(request);
    EXPECT_TRUE(sample.ok()) << sample.status();
    if (!sample.ok()) return {};
    const auto [x, y, z] = sample->points.positions[0];
    return {x, y, z};
  }

  /// The surroundings of a point from so far above it, evenly on the picture, with as many bits as that asks for.
  static v1::SampleRequest near_view(const Place& point, double distance) {
    v1::SampleRequest sample = view(0, 1, 500);
    sample.clear_density();
    sample.clear_encoding();
    sample.add_density()->mutable_screen();
    sample.add_density()->mutable_frustum();
    const auto set = [&](v1::Vec3& to, double scale) {
      to.set_x(scale * point[0]), to.set_y(scale * point[1]), to.set_z(scale * point[2]);
    };
    set(*sample.mutable_cameras(0)->mutable_eye(), 1 + distance);
    set(*sample.mutable_cameras(0)->mutable_target(), 1);
    return sample;
  }

  /// By how much the points of a frame lie beside where they were computed, in pixels of the picture, ascending.
  std::vector<double> pixels_moved(const Frame& frame, v1::SampleRequest sample) {
    sample.mutable_encoding()->mutable_raw();
    v1::ResampleRequest request;
    request.set_session_id(session_id_);
    *request.mutable_sample() = sample;
    const absl::StatusOr<DecodedSample> exact = client_->resample(request);
    EXPECT_TRUE(exact.ok()) << exact.status();
    if (!exact.ok() || exact->points.size() != frame.points->size()) return {HUGE_VAL};
    const v1::Vec3 &eye = sample.cameras(0).eye(), &target = sample.cameras(0).target();
    Place forward = {target.x() - eye.x(), target.y() - eye.y(), target.z() - eye.z()};
    const double reach = std::hypot(forward[0], forward[1], forward[2]);
    for (double& c : forward) c /= reach;
    const auto from_eye = [&](const Points& points, std::size_t i) {
      const auto& p = points.positions[i];
      const auto& o = points.origin;
      return Place{o[0] + double{p[0]} - eye.x(), o[1] + double{p[1]} - eye.y(), o[2] + double{p[2]} - eye.z()};
    };
    std::vector<double> moved;
    for (std::size_t i = 0; i < frame.points->size(); ++i) {
      const Place seen = from_eye(*frame.points, i), wanted = from_eye(exact->points, i);
      const auto depth = [&](const Place& p) { return forward[0] * p[0] + forward[1] * p[1] + forward[2] * p[2]; };
      // On the plane at depth 1, where the default viewport of 45 degrees has so many pixels to a length.
      const double pixels = 512 / std::tan(M_PI / 8);
      Place apart;
      for (std::size_t c = 0; c < 3; ++c) apart[c] = pixels * (seen[c] / depth(seen) - wanted[c] / depth(wanted));
      moved.push_back(std::hypot(apart[0], apart[1], apart[2]));
    }
    std::ranges::sort(moved);
    return moved;
  }

  /// The view's frames, until nothing better follows.
  static Frame settled_frame(ViewStream& stream, const v1::SampleRequest& sample) {
    const absl::StatusOr<std::uint64_t> sequence = stream.send_view(sample);
    EXPECT_TRUE(sequence.ok()) << sequence.status();
    while (true) {
      absl::StatusOr<Frame> frame = stream.next_frame(kPatience);
      EXPECT_TRUE(frame.ok()) << frame.status();
      if (!frame.ok()) return {};
      EXPECT_TRUE(frame->error.ok()) << frame->error;
      if (frame->sequence == *sequence && !frame->statistics.refining()) return *std::move(frame);
    }
  }

  void expect_at_once(const Frame& frame, const v1::SampleRequest& sample) {
    v1::ResampleRequest request;
    request.set_session_id(session_id_);
    *request.mutable_sample() = sample;
    const absl::StatusOr<DecodedSample> whole = client_->resample(request);
    ASSERT_TRUE(whole.ok()) << whole.status();
    ASSERT_EQ(frame.points->size(), whole->points.size());
    ASSERT_EQ(frame.points->positions, whole->points.positions);
    ASSERT_EQ(frame.points->normals, whole->points.normals);
    ASSERT_EQ(frame.points->ranks, whole->points.ranks);
    ASSERT_EQ(frame.points->curvatures, whole->points.curvatures);
    ASSERT_EQ(frame.points->faces, whole->points.faces);
    ASSERT_EQ(frame.points->barycentric, whole->points.barycentric);
    ASSERT_EQ(frame.points->directions, whole->points.directions);
    ASSERT_EQ(frame.points->scalars, whole->points.scalars);
    for (std::size_t i = 0; i < frame.points->size(); ++i) {
      ASSERT_NEAR(frame.points->radii[i] / whole->points.radii[i], 1, 1e-5) << i;
    }
  }

  std::unique_ptr<server::Server> server_;
  std::shared_ptr<Connection> connection_;
  std::unique_ptr<Client> client_;
  std::string session_id_;
};

TEST_F(ViewStreamDelta, AfterTenThousandTheClientHoldsTheServersSet) {
  const auto stream = ViewStream::open(*connection_, session_id_);
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  double degrees = 0, distance = 3, points = 400;
  std::size_t deltas = 0, edits = 0;
  for (int i = 0; deltas < 10'000; ++i) {
    ASSERT_LT(i, 20'000);
    // Steps of all sizes, and sometimes somewhere else altogether.
    const double reach = std::exp2(uniform(-4, 4));
    degrees += i % 97 == 0 ? uniform(0, 360) : uniform(-reach, reach);
    distance = std::clamp(distance * std::exp(0.02 * uniform(-reach, reach)), 1.1, 9.0);
    points = std::clamp(points * std::exp(0.03 * uniform(-reach, reach)), 40.0, 1500.0);
    const v1::SampleRequest sample = view(degrees, distance, static_cast<std::uint64_t>(points));
    const Frame frame = settled_frame(*stream, sample);
    ASSERT_NE(frame.points, nullptr);
    ASSERT_EQ(frame.points->size(), static_cast<std::uint64_t>(points));
    if (frame.is_delta) ++deltas, edits += frame.added + frame.removed + frame.resized;
    if (i % 100 == 0) expect_at_once(frame, sample);
  }
  EXPECT_GT(edits, deltas);
  const v1::SampleRequest last = view(degrees + 1, distance, static_cast<std::uint64_t>(points));
  const Frame frame = settled_frame(*stream, last);
  EXPECT_TRUE(frame.is_delta);
  expect_at_once(frame, last);
  EXPECT_TRUE(stream->close().ok());
}

TEST_F(ViewStreamDelta, AttributesAndRawPointsComeAlong) {
  const auto stream = ViewStream::open(*connection_, session_id_);
  for (int i = 0; i < 30; ++i) {
    v1::SampleRequest sample = view(2.0 * i, 2, 2000);
    sample.mutable_encoding()->mutable_raw();
    for (const v1::PointAttribute attribute :
         {v1::POINT_ATTRIBUTE_RANK, v1::POINT_ATTRIBUTE_CURVATURES, v1::POINT_ATTRIBUTE_SURFACE, v1::POINT_ATTRIBUTE_DIRECTIONS,
          v1::POINT_ATTRIBUTE_SCALARS}) {
      sample.add_attributes(attribute);
    }
    const Frame frame = settled_frame(*stream, sample);
    EXPECT_EQ(frame.is_delta, i > 0);
    EXPECT_EQ(frame.points->ranks.size(), 2000u);
    EXPECT_EQ(frame.points->curvatures.size(), 2000u);
    EXPECT_EQ(frame.points->barycentric.size(), 2000u);
    EXPECT_EQ(frame.points->directions.size(), 2000u);
    ASSERT_EQ(frame.points->scalars.size(), 1u);
    EXPECT_EQ(frame.points->scalars[0].name, "height");
    EXPECT_EQ(frame.points->scalars[0].values.size(), 2000u);
    expect_at_once(frame, sample);
  }
}

TEST_F(ViewStreamDelta, KeyFramesComeWhereDeltasCannot) {
  const auto stream = ViewStream::open(*connection_, session_id_);
  const auto is_delta = [&](const v1::SampleRequest& sample) {
    const Frame frame = settled_frame(*stream, sample);
    expect_at_once(frame, sample);
    return frame.is_delta;
  };
  EXPECT_FALSE(is_delta(view(0, 3, 1000)));
  EXPECT_TRUE(is_delta(view(1, 3, 1000)));
  EXPECT_TRUE(is_delta(view(1, 3, 1000))) << "of nothing at all";
  EXPECT_FALSE(is_delta(view(181, 3, 1000))) << "from the other side";
  v1::SampleRequest finer = view(182, 3, 1000);
  finer.mutable_encoding()->mutable_draco()->set_position_bits(12);
  EXPECT_FALSE(is_delta(finer));
  v1::SampleRequest equalised = view(183, 3, 1000);
  equalised.set_sampler(v1::SAMPLER_EQUALISED);
  EXPECT_FALSE(is_delta(equalised));
  EXPECT_FALSE(is_delta(view(183, 3, 1000)));
  EXPECT_TRUE(is_delta(view(184, 3, 1000)));
  ASSERT_TRUE(stream->send_view(view(185, 3, 1000), /*key_frame=*/true).ok());
  absl::StatusOr<Frame> key = stream->next_frame(kPatience);
  ASSERT_TRUE(key.ok()) << key.status();
  EXPECT_FALSE(key->is_delta);
  EXPECT_TRUE(is_delta(view(186, 3, 1000)));

  const auto keys_only = ViewStream::open(*connection_, session_id_, {}, {.deltas = false});
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(settled_frame(*keys_only, view(i, 3, 1000)).is_delta);
}

TEST_F(ViewStreamDelta, PositionsAreAsFineAsThePictureAsksForAtAnyDepth) {
  const Place point = first_point();
  const auto stream = ViewStream::open(*connection_, session_id_);
  std::vector<double> distances;
  for (double distance = 3; distance > 0.8e-3; distance *= 0.8) distances.push_back(distance);
  bool has_centre = false;
  const auto look = [&](double distance) {
    const v1::SampleRequest sample = near_view(point, distance);
    const Frame frame = settled_frame(*stream, sample);
    EXPECT_GT(frame.points->size(), 0u);
    const std::vector<double> moved = pixels_moved(frame, sample);
    // What is held since the camera was four times as far away, some of the points, has four times the steps.
    EXPECT_LE(moved.back(), frame.is_delta ? 2.01 : 0.51) << "at " << distance;
    EXPECT_LE(moved[moved.size() * 4 / 5], 0.5) << "at " << distance;
    has_centre = has_centre || frame.points->origin != std::array<double, 3>{};
    return frame;
  };
  for (const double distance : distances) look(distance);
  EXPECT_TRUE(has_centre) << "floats that count from the box's corner would not do";
  std::ranges::reverse(distances);
  for (const double distance : distances) {
    look(distance);
    // To and fro, nothing asks for all points anew.
    look(1.1 * distance);
    EXPECT_TRUE(look(distance).is_delta) << "at " << distance;
  }
}

TEST_F(ViewStreamDelta, ABrokenStreamIsResumedWithTheBitsThatItHad) {
  const Place point = first_point();
  // Seen from farther away first: the client's lattice is coarser than that of the view that it ends with.
  HeldFrame held;
  const v1::SampleRequest sample = near_view(point, 1.2);
  {
    const auto stream = ViewStream::open(*connection_, session_id_);
    settled_frame(*stream, near_view(point, 1.6));
    EXPECT_TRUE(settled_frame(*stream, sample).is_delta);
    held = stream->held();
  }
  const auto fresh = ViewStream::open(*connection_, session_id_);
  EXPECT_NE(settled_frame(*fresh, sample).points->positions, held.points->positions);
  const auto again = ViewStream::open(*connection_, session_id_, {}, {.held = held});
  const Frame frame = settled_frame(*again, sample);
  EXPECT_TRUE(frame.is_delta);
  EXPECT_EQ(frame.points->positions, held.points->positions);
}

TEST_F(ViewStreamDelta, ABrokenStreamIsResumed) {
  HeldFrame held;
  {
    const auto stream = ViewStream::open(*connection_, session_id_);
    EXPECT_EQ(stream->held().digest, 0u);
    settled_frame(*stream, view(0, 3, 3000));
    settled_frame(*stream, view(1, 3, 3000));
    held = stream->held();
  }
  ASSERT_NE(held.digest, 0u);
  EXPECT_EQ(held.points->size(), 3000u);
  const auto again = ViewStream::open(*connection_, session_id_, {}, {.held = held});
  const Frame frame = settled_frame(*again, view(2, 3, 3000));
  EXPECT_TRUE(frame.is_delta);
  EXPECT_LT(frame.added, 1000u);
  expect_at_once(frame, view(2, 3, 3000));

  // A server that finds other points sends all.
  held.digest ^= 1;
  const auto false_claim = ViewStream::open(*connection_, session_id_, {}, {.held = held});
  const Frame whole = settled_frame(*false_claim, view(2, 3, 3000));
  EXPECT_FALSE(whole.is_delta);
  expect_at_once(whole, view(2, 3, 3000));
}

TEST_F(ViewStreamDelta, LargeFramesComeInParts) {
  const auto stream = ViewStream::open(*connection_, session_id_, {}, {.first_bytes = 2000});
  const v1::SampleRequest sample = view(0, 1.5, 8000);
  ASSERT_TRUE(stream->send_view(sample).ok());
  std::vector<std::size_t> sizes;
  Frame frame;
  do {
    absl::StatusOr<Frame> next = stream->next_frame(kPatience);
    ASSERT_TRUE(next.ok()) << next.status();
    EXPECT_TRUE(!next->is_delta || next->removed == 0) << "a part only adds";
    if (sizes.empty()) {
      EXPECT_LT(next->encoded_bytes, 3500u);
    }
    frame = *std::move(next);
    sizes.push_back(frame.points->size());
  } while (frame.statistics.refining());
  EXPECT_GE(sizes.size(), 3u);
  EXPECT_TRUE(std::ranges::is_sorted(sizes));
  expect_at_once(frame, sample);
}

TEST_F(ViewStreamDelta, AnAutomaticBudgetStaysWithinItsLimit) {
  const auto stream = ViewStream::open(*connection_, session_id_);
  for (int i = 0; i < 40; ++i) {
    v1::SampleRequest sample = view(i, 3, 0);
    sample.mutable_automatic()->set_frame_seconds(5);
    sample.mutable_automatic()->set_max_points(3000);
    EXPECT_EQ(settled_frame(*stream, sample).points->size(), 3000u);
  }
  v1::ResampleRequest request;
  request.set_session_id(session_id_);
  *request.mutable_sample() = view(0, 3, 0);
  request.mutable_sample()->mutable_automatic();
  EXPECT_TRUE(absl::IsInvalidArgument(client_->resample(request).status()));
}

}  // namespace
}  // namespace curvecast::client
