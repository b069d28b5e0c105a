#include "core/density/picture_detail.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/density/density.h"
#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::sphere_curve;

std::vector<float> detail_of(const SurfaceCurve& curve) {
  std::vector<float> values(curve.size(), 1.0f);
  multiply_picture_detail(curve, values);
  return values;
}

/// Places along the x axis, half a unit apart, of no curvature, all black.
SurfaceCurve black_row(std::size_t n, double diagonal) {
  SurfaceCurve curve;
  curve.resize(n, true);
  for (std::size_t l = 0; l < n; ++l) {
    curve.x[l] = 0.5f * static_cast<float>(l);
    curve.y[l] = curve.z[l] = 0;
    curve.curvature_min[l] = curve.curvature_max[l] = 0.0f;
    curve.colour[l] = {0, 0, 0, 255};
  }
  curve.box.extend(Vec3d::Zero());
  curve.box.extend(Vec3d(diagonal, 0, 0));
  return curve;
}

TEST(PictureDetail, GrowsWithTheLargerCurvatureUpToWhatIsStrong) {
  const SurfaceCurve curve = sphere_curve(2000, 3);
  const std::vector<float> values = detail_of(curve);
  const float strong = curve.reference_curvature[static_cast<std::size_t>(CurvatureKind::kMax)];
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const float k = std::max(std::abs(float{curve.curvature_min[l]}), std::abs(float{curve.curvature_max[l]}));
    ASSERT_NEAR(values[l], kLeastDetail + (1 - kLeastDetail) * std::min(k / strong, 1.0f), 1e-5) << l;
  }
  EXPECT_FLOAT_EQ(std::ranges::min(values), kLeastDetail) << "flat places are there";
  EXPECT_FLOAT_EQ(std::ranges::max(values), 1);
}

TEST(PictureDetail, GrowsWithTheChangeOfColour) {
  constexpr double kDiagonal = 100;
  SurfaceCurve curve = black_row(20, kDiagonal);
  for (std::size_t l = 10; l < 20; ++l) curve.colour[l].g = 51;  // a fifth
  const std::vector<float> values = detail_of(curve);
  const double change = 0.2 / 0.5 * kDiagonal / kStrongChange;
  for (std::size_t l = 0; l < 20; ++l) {
    const double expected = l == 9 || l == 10 ? kLeastDetail + (1 - kLeastDetail) * std::min(change, 1.0) : kLeastDetail;
    EXPECT_NEAR(values[l], expected, 1e-5) << l;
  }
}

TEST(PictureDetail, IsTheSameInEveryUnit) {
  const std::vector<float> one = detail_of(sphere_curve(500, 1)), other = detail_of(sphere_curve(500, 1e4));
  for (std::size_t l = 0; l < one.size(); ++l) EXPECT_NEAR(one[l], other[l], 0.03) << l;  // what is strong is known within 2 %
}

TEST(PictureDetail, IsOneOnWhatIsFlatAndOfOneColour) {
  SurfaceCurve curve = sphere_curve(100);
  curve.reference_curvature = {};
  EXPECT_EQ(detail_of(curve), std::vector<float>(100, 1.0f));
  // Places with one position have no change between them.
  SurfaceCurve twice = black_row(4, 10);
  for (std::size_t l = 0; l < 4; ++l) twice.x[l] = 1, twice.colour[l].r = static_cast<std::uint8_t>(l);
  EXPECT_EQ(detail_of(twice), std::vector<float>(4, kLeastDetail));
}

TEST(PictureDetail, IsAFactorOfThePictureTermBesideScreenOutlinesAndFrustum) {
  const SurfaceCurve curve = sphere_curve(3000);
  std::vector<Camera> cameras = {camera_at(Vec3d(0, 0, 1.2)), camera_at(Vec3d(2, 1, 0))};
  cameras[1].height = 0.7;
  std::vector<float> picture(curve.size()), others(curve.size());
  ASSERT_TRUE(evaluate_density(curve, Density({PictureTerm{}}, cameras), picture).ok());
  ASSERT_TRUE(evaluate_density(curve, Density({ScreenTerm{}, ViewTerm{kPictureFloor}, FrustumTerm{}}, cameras), others).ok());
  multiply_picture_detail(curve, others);
  std::size_t in_pictures = 0, beside = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    if (others[l] > 0) {
      ASSERT_NEAR(picture[l], others[l], 1e-6 * others[l]) << l;
      ++in_pictures;
    } else if (picture[l] > 0) {
      ++beside;
    }
  }
  EXPECT_GT(in_pictures, 100u);
  EXPECT_GT(beside, 0u) << "a margin";
  EXPECT_LT(beside, in_pictures / 10);
  EXPECT_EQ(evaluate_density(curve, Density({PictureTerm{}}), picture).code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast
