#include "server/convert/convert_density.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/server/frame/sample_request.h"

namespace curvecast::server {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ConvertDensity, TakesCamerasAndTerms) {
  v1::SampleRequest request = good_request();
  request.clear_viewport();
  *request.add_cameras() = request.cameras(0);
  request.mutable_cameras(1)->set_orthographic_height(7);
  request.mutable_cameras(0)->set_vertical_fov_degrees(90);
  v1::BrushStroke& stroke = *request.mutable_density(4)->mutable_brush()->mutable_strokes(0);
  stroke.set_falloff(0);
  for (const float x : {1.0f, 0.0f, -2.0f, 0.0f, 0.5f, 0.0f}) stroke.add_path(x);
  v1::DistanceDensity& distance = *request.mutable_density(5)->mutable_distance();
  distance.set_near(2);
  distance.set_far(5);
  distance.set_global(true);
  distance.set_fall(v1::DISTANCE_FALL_LINEAR);
  request.set_pixel_error(2.5);
  auto sample = to_point_set_request(request);
  ASSERT_TRUE(sample.ok()) << sample.status();
  ASSERT_EQ(sample->options.density.cameras.size(), 2u);
  EXPECT_EQ(sample->options.density.cameras[0].fov, std::acos(-1) / 2);
  EXPECT_EQ(sample->options.density.cameras[0].aspect, 1);
  EXPECT_EQ(sample->options.density.cameras[0].pixels, 1024);
  EXPECT_EQ(sample->options.density.cameras[1].height, 7);
  EXPECT_EQ(std::get<BrushTerm>(sample->options.density.terms[4]).dabs,
            (std::vector<Dab>{{{1, 0, 0}, 2, 3, 0}, {{2, 0, -2}, 2, 3, 0}, {{1, 0.5, 0}, 2, 3, 0}}));
  EXPECT_EQ(std::get<DistanceTerm>(sample->options.density.terms[5]).near, 2);
  EXPECT_EQ(std::get<DistanceTerm>(sample->options.density.terms[5]).far, 5);
  EXPECT_TRUE(std::get<DistanceTerm>(sample->options.density.terms[5]).global);
  EXPECT_EQ(std::get<DistanceTerm>(sample->options.density.terms[5]).fall, DistanceFall::kLinear);
  EXPECT_EQ(sample->pixel_error, 2.5);
  request.set_max_bytes(5000);
  sample = to_point_set_request(request);
  ASSERT_TRUE(sample.ok()) << sample.status();
  EXPECT_EQ(sample->pixel_error, 0);
  EXPECT_EQ(sample->max_bytes, 5000u);
}

TEST(ConvertDensity, NamesTheFieldAtFault) {
  expect_refusals({
      {"sample.cameras[0].eye.x is not finite", [](auto& r) { r.mutable_cameras(0)->mutable_eye()->set_x(kNan); }},
      {"sample.cameras[0].eye.y is not finite", [](auto& r) { r.mutable_cameras(0)->mutable_eye()->set_y(kInf); }},
      {"sample.cameras[0].eye.z is not finite", [](auto& r) { r.mutable_cameras(0)->mutable_eye()->set_z(-kInf); }},
      {"sample.cameras[0].target.x is not finite", [](auto& r) { r.mutable_cameras(0)->mutable_target()->set_x(kNan); }},
      {"sample.cameras[0].target.z is not finite", [](auto& r) { r.mutable_cameras(0)->mutable_target()->set_z(kInf); }},
      {"sample.cameras[0].up.y is not finite", [](auto& r) { r.mutable_cameras(0)->mutable_up()->set_y(kNan); }},
      {"same point", [](auto& r) { r.mutable_cameras(0)->clear_eye(); }},
      {"sample.cameras[0]: up has no length", [](auto& r) { r.mutable_cameras(0)->mutable_up(); }},
      {"sample.cameras[0]: up is along the view", [](auto& r) { r.mutable_cameras(0)->mutable_up()->set_z(-1e-200); }},
      {"vertical_fov_degrees is 180", [](auto& r) { r.mutable_cameras(0)->set_vertical_fov_degrees(180); }},
      {"vertical_fov_degrees is -1", [](auto& r) { r.mutable_cameras(0)->set_vertical_fov_degrees(-1); }},
      {"vertical_fov_degrees is nan", [](auto& r) { r.mutable_cameras(0)->set_vertical_fov_degrees(kNan); }},
      {"sample.density has 17 terms",
       [](auto& r) {
         while (r.density_size() < 17) r.add_density()->mutable_uniform();
       }},
      {"sample.density[9] holds no term", [](auto& r) { r.add_density(); }},
      {"sample.cameras has 17 cameras",
       [](auto& r) {
         while (r.cameras_size() < 17) *r.add_cameras() = r.cameras(0);
       }},
      {"sample.cameras[0].orthographic_height is -1", [](auto& r) { r.mutable_cameras(0)->set_orthographic_height(-1); }},
      {"sample.cameras[0].orthographic_height is not finite",
       [](auto& r) { r.mutable_cameras(0)->set_orthographic_height(kNan); }},
      {"sample.density[3].attribute.name is empty", [](auto& r) { r.mutable_density(3)->mutable_attribute()->clear_name(); }},
      {"sample.density[4].brush.strokes[0].path has 4 numbers",
       [](auto& r) {
         for (int i = 0; i < 4; ++i) r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->add_path(0);
       }},
      {"sample.density[4].brush.strokes[0].path is not finite",
       [](auto& r) {
         for (int i = 0; i < 3; ++i) r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->add_path(NAN);
       }},
      {"sample.density has 10001 dabs of the brush; at most 10000",
       [](auto& r) {
         for (int i = 0; i < 30'000; ++i) r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->add_path(0);
       }},
      {"sample.density[4].brush.strokes[0].centre.y is not finite",
       [](auto& r) { r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->mutable_centre()->set_y(kNan); }},
      {"sample.density[4].brush.strokes[0].radius is 0",
       [](auto& r) { r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->set_radius(0); }},
      {"sample.density[4].brush.strokes[0].radius is not finite",
       [](auto& r) { r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->set_radius(kInf); }},
      {"sample.density[4].brush.strokes[0].factor is -1",
       [](auto& r) { r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->set_factor(-1); }},
      {"sample.density[4].brush.strokes[0].factor is nan",
       [](auto& r) { r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->set_factor(kNan); }},
      {"sample.density[4].brush.strokes[0].falloff is 1.5",
       [](auto& r) { r.mutable_density(4)->mutable_brush()->mutable_strokes(0)->set_falloff(1.5); }},
      {"sample.density[5].distance.near is -1", [](auto& r) { r.mutable_density(5)->mutable_distance()->set_near(-1); }},
      {"sample.density[5].distance.near is not finite",
       [](auto& r) { r.mutable_density(5)->mutable_distance()->set_near(kInf); }},
      {"sample.density[5].distance.far is not finite", [](auto& r) { r.mutable_density(5)->mutable_distance()->set_far(kNan); }},
      {"sample.density[5].distance.far is 1, less than near, 2",
       [](auto& r) {
         r.mutable_density(5)->mutable_distance()->set_near(2);
         r.mutable_density(5)->mutable_distance()->set_far(1);
       }},
      {"sample.density[8].expression.text: expression density: the formula is empty",
       [](auto& r) { r.mutable_density(8)->mutable_expression()->clear_text(); }},
      {"sample.density[8].expression.text: expression density '1 +'",
       [](auto& r) { r.mutable_density(8)->mutable_expression()->set_text("1 +"); }},
      {"sample.density[1].curvature.kind has the unknown value 77",
       [](auto& r) { r.mutable_density(1)->mutable_curvature()->set_kind(static_cast<v1::CurvatureKind>(77)); }},
      {"sample.density[1].curvature.exponent is not finite",
       [](auto& r) { r.mutable_density(1)->mutable_curvature()->set_exponent(kInf); }},
      {"sample.density[1].curvature.exponent is -1",
       [](auto& r) { r.mutable_density(1)->mutable_curvature()->set_exponent(-1); }},
      {"sample.density[1].curvature.floor is nan", [](auto& r) { r.mutable_density(1)->mutable_curvature()->set_floor(kNan); }},
      {"sample.density[1].curvature.floor is 1.5", [](auto& r) { r.mutable_density(1)->mutable_curvature()->set_floor(1.5); }},
      {"sample.density[2] needs a camera in sample.cameras", [](auto& r) { r.clear_cameras(); }},
      {"sample.density[2].view.s0 is 0", [](auto& r) { r.mutable_density(2)->mutable_view()->set_s0(0); }},
      {"sample.density[2].view.s0 is not finite", [](auto& r) { r.mutable_density(2)->mutable_view()->set_s0(kNan); }},
  });
}

TEST(ConvertDensity, CamerasOfAnySizeWillDo) {
  for (const double scale : {1e-300, 1e-20, 1.0, 1e20, 1.7e308}) {
    v1::SampleRequest request = good_request();
    request.mutable_cameras(0)->mutable_eye()->set_z(scale);
    request.mutable_cameras(0)->mutable_target()->set_z(-scale);
    EXPECT_TRUE(to_point_set_request(request).ok()) << scale;
    request.mutable_cameras(0)->mutable_up()->set_z(scale);
    EXPECT_FALSE(to_point_set_request(request).ok()) << scale;
  }
}

TEST(ConvertDensity, RefusesAFallThatSaysNothing) {
  const auto error_of = [](auto change) {
    v1::SampleRequest request = good_request();
    change(*request.mutable_density(5)->mutable_distance());
    return std::string(to_point_set_request(request).status().message());
  };
  const auto falls = [](v1::DistanceFall fall, bool global) {
    return [=](v1::DistanceDensity& distance) {
      distance.set_global(global);
      distance.set_fall(fall);
    };
  };
  EXPECT_THAT(error_of(falls(v1::DISTANCE_FALL_LINEAR, true)), ::testing::HasSubstr("density[5].distance.fall is LINEAR"));
  EXPECT_THAT(error_of(falls(v1::DISTANCE_FALL_INVERSE, false)), ::testing::HasSubstr("density[5].distance.fall is of global"));
  EXPECT_THAT(error_of(falls(static_cast<v1::DistanceFall>(9), true)), ::testing::HasSubstr("fall has the unknown value 9"));
}

TEST(ConvertDensity, CameraTermsKeepTheirFields) {
  EXPECT_EQ(to_proto(DensityTerm(ViewTerm{2})).view().s0(), 2);
  EXPECT_TRUE(to_proto(DensityTerm(FrustumTerm{})).has_frustum());
  EXPECT_TRUE(to_proto(DensityTerm(ScreenTerm{})).has_screen());
  EXPECT_TRUE(to_proto(DensityTerm(PictureTerm{})).has_picture());
  const v1::DistanceDensity distance = to_proto(DensityTerm(DistanceTerm{1, 2, true})).distance();
  EXPECT_EQ(distance.near(), 1);
  EXPECT_EQ(distance.far(), 2);
  EXPECT_TRUE(distance.global());
  EXPECT_EQ(distance.fall(), v1::DISTANCE_FALL_INVERSE_SQUARE);
  EXPECT_EQ(to_proto(DensityTerm(DistanceTerm{})).distance().far(), 0) << "no limit";
}

}  // namespace
}  // namespace curvecast::server
