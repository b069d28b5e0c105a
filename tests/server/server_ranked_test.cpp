// The progressive sampler, over TCP.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "server_fixture.h"

#include "tests/server/convert/values_of.h"
#include "tests/server/frame/frame_points.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerRanked : public ServerFixture {
 protected:
  void SetUp() override {
    ServerFixture::SetUp();
    stub_ = client();
    const Created created = create(*stub_, upload(*stub_, sphere_off(4)), 5000);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    session_id_ = created.session.session_id();
  }

  static v1::SampleRequest ranked_view(std::uint64_t points) {
    v1::SampleRequest sample = view_of(points);
    sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    sample.mutable_encoding()->mutable_raw();
    sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
    return sample;
  }

  static std::vector<std::uint32_t> ranks_of(const v1::PointBlock& block) {
    return values_of<std::uint32_t>(block.attributes().ranks());
  }

  std::set<std::uint32_t> ranks_of(const v1::SampleRequest& sample) {
    const Resampled resampled = resample(*stub_, session_id_, sample);
    EXPECT_TRUE(resampled.status.ok()) << resampled.status.error_message();
    std::set<std::uint32_t> ranks;
    for (const v1::ResampleResponse& response : resampled.blocks) {
      for (const std::uint32_t rank : ranks_of(response.points())) EXPECT_TRUE(ranks.insert(rank).second);
    }
    return ranks;
  }

  std::unique_ptr<Stub> stub_;
  std::string session_id_;
};

TEST_F(ServerRanked, MorePointsAddToFewer) {
  std::set<std::uint32_t> fewer;
  for (const std::uint64_t points : {1u, 100u, 5000u, 20'000u}) {
    const std::set<std::uint32_t> more = ranks_of(ranked_view(points));
    EXPECT_EQ(more.size(), points);
    EXPECT_TRUE(std::includes(more.begin(), more.end(), fewer.begin(), fewer.end()));
    fewer = more;
  }
  v1::SampleRequest everywhere = ranked_view(3000);
  everywhere.clear_density();
  const std::set<std::uint32_t> lowest = ranks_of(everywhere);
  EXPECT_EQ(lowest.size(), 3000u);
  EXPECT_EQ(*lowest.rbegin(), 2999u);
}

TEST_F(ServerRanked, TheSameRequestGivesTheSameBytes) {
  const Resampled first = resample(*stub_, session_id_, ranked_view(9000));
  ranks_of(ranked_view(30'000));  // more candidates are there now
  const Resampled again = resample(*stub_, session_id_, ranked_view(9000));
  EXPECT_EQ(first.points(), 9000u);
  EXPECT_EQ(first.bytes(), again.bytes());
}

TEST_F(ServerRanked, FarMorePointsThanACoarseCurveIsMadeForAreEncodedToo) {
  for (int levels = 1; levels <= 3; ++levels) {
    const Created coarse = create(*stub_, upload(*stub_, sphere_off(levels)), 100);
    ASSERT_TRUE(coarse.status.ok()) << coarse.status.error_message();
    v1::SampleRequest sample = ranked_view(3000);
    sample.clear_encoding();
    sample.clear_density();
    const Resampled resampled = resample(*stub_, coarse.session.session_id(), sample);
    EXPECT_TRUE(resampled.status.ok()) << resampled.status.error_message();
  }
}

TEST_F(ServerRanked, AStreamComesToWhatResampleGives) {
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub_->StreamViews(&context);
  v1::StreamViewsRequest request;
  request.mutable_open()->set_session_id(session_id_);
  stream->Write(request);
  request.mutable_view()->set_sequence(1);
  *request.mutable_view()->mutable_sample() = ranked_view(20'000);
  stream->Write(request);
  v1::StreamViewsResponse response;
  int frames = 0;
  do {
    ASSERT_TRUE(stream->Read(&response));
    ASSERT_FALSE(response.frame().has_error()) << response.frame().error().message();
    EXPECT_EQ(response.frame().sequence(), 1u);
    request.mutable_ack()->set_sequence(1);
    stream->Write(request);
    ++frames;
  } while (response.frame().statistics().refining());
  EXPECT_GT(frames, 1) << "the first one has few points, but at once";
  EXPECT_EQ(count_points(response.frame()), 20'000u);
  const Resampled resampled = resample(*stub_, session_id_, ranked_view(20'000));
  ASSERT_EQ(resampled.blocks.size(), 2u);
  EXPECT_EQ(point_bytes(response.frame()), resampled.bytes());
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(ServerRanked, SendsTheAttributesAskedFor) {
  v1::SampleRequest sample = ranked_view(1000);
  sample.add_attributes(v1::POINT_ATTRIBUTE_CURVATURES);
  sample.add_attributes(v1::POINT_ATTRIBUTE_SURFACE);
  for (const bool progressive : {true, false}) {
    if (!progressive) {
      sample.set_sampler(v1::SAMPLER_EQUALISED);
      sample.mutable_attributes()->erase(sample.attributes().begin());
      sample.mutable_encoding()->mutable_draco();
    }
    const Resampled resampled = resample(*stub_, session_id_, sample);
    ASSERT_TRUE(resampled.status.ok()) << resampled.status.error_message();
    ASSERT_EQ(resampled.blocks.size(), 1u);
    const v1::PointAttributes& attributes = resampled.blocks[0].points().attributes();
    EXPECT_EQ(attributes.ranks().size(), progressive ? 4000u : 0u);
    EXPECT_EQ(attributes.faces().size(), 4000u);
    ASSERT_EQ(attributes.curvatures().size(), 8000u);
    ASSERT_EQ(attributes.barycentric().size(), 8000u);
    for (std::size_t i = 0; i < 1000; ++i) {
      std::uint32_t face;
      float curvatures[2], weights[2];
      std::memcpy(&face, attributes.faces().data() + 4 * i, sizeof(face));
      std::memcpy(curvatures, attributes.curvatures().data() + 8 * i, sizeof(curvatures));
      std::memcpy(weights, attributes.barycentric().data() + 8 * i, sizeof(weights));
      EXPECT_LT(face, 8u * 256);
      EXPECT_NEAR(curvatures[0], 1, 0.2);
      EXPECT_NEAR(curvatures[1], 1, 0.2);
      EXPECT_GE(std::min({weights[0], weights[1], 1 - weights[0] - weights[1]}), -1e-4);
    }
  }
}

TEST_F(ServerRanked, RefusesWhatCannotBe) {
  v1::SampleRequest sample = ranked_view(100);
  sample.set_sampler(v1::SAMPLER_EQUALISED);
  Resampled resampled = resample(*stub_, session_id_, sample);
  EXPECT_EQ(resampled.status.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(resampled.status.error_message(), HasSubstr("sample.attributes"));
  sample = ranked_view(100);
  sample.set_sampler(static_cast<v1::Sampler>(77));
  resampled = resample(*stub_, session_id_, sample);
  EXPECT_EQ(resampled.status.error_code(), grpc::INVALID_ARGUMENT);
  EXPECT_THAT(resampled.status.error_message(), HasSubstr("sample.sampler"));
  sample = ranked_view(100);
  sample.add_attributes(static_cast<v1::PointAttribute>(77));
  EXPECT_EQ(resample(*stub_, session_id_, sample).status.error_code(), grpc::INVALID_ARGUMENT);
  sample = ranked_view(4'000'001);
  EXPECT_EQ(resample(*stub_, session_id_, sample).status.error_code(), grpc::OUT_OF_RANGE);
  // From within the ball nothing faces the eye.
  sample = ranked_view(100);
  sample.mutable_cameras(0)->mutable_eye()->set_z(0.1);
  sample.mutable_cameras(0)->mutable_target()->set_x(0.5);
  EXPECT_EQ(resample(*stub_, session_id_, sample).status.error_code(), grpc::FAILED_PRECONDITION);
}

}  // namespace
}  // namespace curvecast::server
