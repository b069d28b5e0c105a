// Render, over TCP.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "core/mesh_io/reading/texture_image.h"
#include "server_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerRender : public ServerFixture {
 protected:
  void SetUp() override {
    ServerFixture::SetUp();
    stub_ = client();
    request_.set_session_id(create(*stub_, upload(*stub_, sphere_off(3)), 2000).session.session_id());
    request_.set_width(160);
    request_.set_height(120);
  }
  grpc::Status render(v1::RenderResponse* response) {
    grpc::ClientContext context;
    set_patience(context);
    return stub_->Render(&context, request_, response);
  }
  /// The picture. Its background has one colour in each row.
  Image picture(std::uint64_t points = 2000) {
    v1::RenderResponse response;
    const grpc::Status status = render(&response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(response.points(), points);
    absl::StatusOr<Image> image = decode_texture(response.png(), 1 << 24);
    EXPECT_TRUE(image.ok()) << image.status();
    return image.ok() ? *std::move(image) : Image();
  }
  std::string refusal() {
    v1::RenderResponse response;
    const grpc::Status status = render(&response);
    EXPECT_EQ(status.error_code(), grpc::INVALID_ARGUMENT) << status.error_message();
    return status.error_message();
  }
  v1::Camera& camera() {
    v1::SampleRequest& sample = *request_.mutable_sample();
    v1::Camera& to = sample.cameras().empty() ? *sample.add_cameras() : *sample.mutable_cameras(0);
    to.mutable_eye()->set_z(4);
    to.mutable_target()->set_z(0);
    return to;
  }

  std::unique_ptr<Stub> stub_;
  v1::RenderRequest request_;
};

bool is_background(const Image& image, int x, int y) {
  for (int channel = 0; channel < 3; ++channel) {
    const auto at = [&](int column) { return int{image.rgba[4 * (y * image.width + column) + channel]}; };
    if (std::abs(at(x) - at(0)) > 2) return false;
  }
  return true;
}

int covered(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += is_background(image, x, y) ? 0 : 1;
  }
  return count;
}

/// A ball of radius 1 is seen from 4 units away under 29 degrees: a disc of 42.6 pixels' radius, without a hole.
void expect_ball(const Image& image, double slack) {
  ASSERT_EQ(image.width, 160);
  ASSERT_EQ(image.height, 120);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double r = std::hypot(x + 0.5 - 80, y + 0.5 - 60);
      if (r > 41 && r < 43 + slack) continue;
      ASSERT_EQ(is_background(image, x, y), r > 43) << x << ", " << y;
    }
  }
}

TEST_F(ServerRender, DrawsAClosedSurface) {
  camera().set_vertical_fov_degrees(40);
  expect_ball(picture(), 3);
}

TEST_F(ServerRender, DrawsTheMeshItself) {
  camera().set_vertical_fov_degrees(40);
  request_.set_style(v1::PICTURE_STYLE_MESH);
  expect_ball(picture(0), 0.5);
}

TEST_F(ServerRender, TheMeshNeedsNoPointsToBeSeen) {
  request_.set_style(v1::PICTURE_STYLE_MESH);
  const Image image = picture(0);
  request_.mutable_sample()->set_points(5);
  EXPECT_EQ(picture(0).rgba, image.rgba);
  request_.set_plain(true);
  EXPECT_EQ(picture(0).rgba, image.rgba);
}

TEST_F(ServerRender, ShowsAllOfItWithoutACamera) {
  const Image image = picture();
  ASSERT_EQ(image.width, 160);
  EXPECT_GT(covered(image), 4000);
  for (int x = 0; x < image.width; ++x) {
    EXPECT_TRUE(is_background(image, x, 1));
    EXPECT_TRUE(is_background(image, x, image.height - 2));
  }
}

TEST_F(ServerRender, DrawsDots) {
  camera();
  const Image surface = picture();
  request_.set_style(v1::PICTURE_STYLE_DOTS);
  const Image dots = picture();
  ASSERT_EQ(dots.rgba.size(), surface.rgba.size());
  EXPECT_NE(dots.rgba, surface.rgba);
}

TEST_F(ServerRender, HasASizeOfItsOwn) {
  request_.clear_width();
  request_.clear_height();
  const Image image = picture();
  EXPECT_EQ(image.width, 1280);
  EXPECT_EQ(image.height, 960);
}

TEST_F(ServerRender, TheSameRequestGivesTheSameBytes) {
  for (const v1::PictureFormat format : {v1::PICTURE_FORMAT_PNG, v1::PICTURE_FORMAT_JPEG}) {
    request_.set_format(format);
    v1::RenderResponse once, again;
    ASSERT_TRUE(render(&once).ok() && render(&again).ok());
    EXPECT_EQ(once.SerializeAsString(), again.SerializeAsString());
  }
}

TEST_F(ServerRender, AJpegShowsTheSameInFewerBytes) {
  camera();
  v1::RenderResponse png, jpeg, rough;
  ASSERT_TRUE(render(&png).ok());
  EXPECT_EQ(png.jpeg(), "");
  request_.set_format(v1::PICTURE_FORMAT_JPEG);
  ASSERT_TRUE(render(&jpeg).ok());
  EXPECT_EQ(jpeg.png(), "");
  EXPECT_EQ(jpeg.points(), png.points());
  request_.set_jpeg_quality(20);
  ASSERT_TRUE(render(&rough).ok());
  EXPECT_LT(jpeg.jpeg().size(), png.png().size());
  EXPECT_LT(rough.jpeg().size(), jpeg.jpeg().size());
  const absl::StatusOr<Image> exact = decode_texture(png.png(), 1 << 24), lossy = decode_texture(jpeg.jpeg(), 1 << 24);
  ASSERT_TRUE(exact.ok() && lossy.ok());
  ASSERT_EQ(lossy->rgba.size(), exact->rgba.size());
  double sum = 0;
  for (std::size_t i = 0; i < exact->rgba.size(); ++i) sum += std::abs(int{exact->rgba[i]} - int{lossy->rgba[i]});
  EXPECT_LT(sum / static_cast<double>(exact->rgba.size()), 3);
}

TEST_F(ServerRender, HasALightAndADarkBackground) {
  camera();
  const Image light = picture();
  request_.set_background(v1::PICTURE_BACKGROUND_LIGHT);
  EXPECT_EQ(picture().rgba, light.rgba);
  request_.set_background(v1::PICTURE_BACKGROUND_DARK);
  const Image dark = picture();
  for (const int row : {0, dark.height - 1}) {
    const std::size_t at = 4 * static_cast<std::size_t>(row * dark.width);
    EXPECT_GT(light.rgba[at], 200);
    EXPECT_LT(dark.rgba[at], 60);
  }
  EXPECT_NEAR(covered(dark), covered(light), 0.02 * covered(light));
}

TEST_F(ServerRender, RefusesWhatIsNoPicture) {
  request_.set_width(4097);
  EXPECT_THAT(refusal(), HasSubstr("width is 4097"));
  request_.set_width(4096);
  request_.set_height(4096);
  EXPECT_THAT(refusal(), HasSubstr("at most 4194304"));
  request_.set_width(10);
  request_.set_height(10);
  request_.set_style(static_cast<v1::PictureStyle>(77));
  EXPECT_THAT(refusal(), HasSubstr("style has the unknown value 77"));
  request_.clear_style();
  request_.set_format(static_cast<v1::PictureFormat>(77));
  EXPECT_THAT(refusal(), HasSubstr("format has the unknown value 77"));
  request_.clear_format();
  request_.set_background(static_cast<v1::PictureBackground>(77));
  EXPECT_THAT(refusal(), HasSubstr("background has the unknown value 77"));
  request_.clear_background();
  request_.set_jpeg_quality(101);
  EXPECT_THAT(refusal(), HasSubstr("jpeg_quality is 101"));
  request_.clear_jpeg_quality();
  camera().set_orthographic_height(1);
  EXPECT_THAT(refusal(), HasSubstr("a perspective one"));
  camera().clear_orthographic_height();
  *request_.mutable_sample()->add_cameras() = camera();
  EXPECT_THAT(refusal(), HasSubstr("one camera"));
  request_.mutable_sample()->clear_cameras();
  request_.mutable_sample()->set_max_bytes(5000);
  EXPECT_THAT(refusal(), HasSubstr("a number of points"));
  request_.mutable_sample()->set_points(0);
  EXPECT_THAT(refusal(), HasSubstr("points"));
  request_.clear_sample();
  request_.set_session_id("nobody's");
  v1::RenderResponse response;
  EXPECT_EQ(render(&response).error_code(), grpc::NOT_FOUND);
}

}  // namespace
}  // namespace curvecast::server
