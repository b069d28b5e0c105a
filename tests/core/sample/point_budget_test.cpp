#include "core/sample/point_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "core/density/view_factor.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::seen_from;

std::shared_ptr<const SurfaceCurve> ball() {
  static const std::shared_ptr<const SurfaceCurve> curve =
      preprocess({"ball.off", testing::to_off(testing::icosphere(5))}, {.points = 10'000})->curve;
  return curve;
}

/// From all vertices.
double expected_points(const SurfaceCurve& curve, const Density& density, double pixels) {
  std::vector<float> values(curve.size()), area(curve.size());
  EXPECT_TRUE(evaluate_density(curve, density, values).ok());
  const Density screen({ScreenTerm{}, FrustumTerm{}}, density.cameras);
  EXPECT_TRUE(evaluate_density(curve, screen, area).ok());
  double mass = 0, largest = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    mass += static_cast<double>(values[l]) * static_cast<double>(curve.area[l]);
    if (values[l] > 0) largest = std::max(largest, static_cast<double>(area[l]) / static_cast<double>(values[l]));
  }
  return mass * largest * ViewFactor(curve, screen).pixels() / pixels / pixels;
}

absl::StatusOr<std::uint64_t> points_for(const Density& density, double pixels) {
  return points_for_pixel_error(*ball(), make_fixed_density(*ball(), density.terms).value().get(), density, pixels);
}

TEST(PointsForPixelError, IsThatOfTheWorstPlace) {
  const std::vector<std::vector<DensityTerm>> term_sets = {
      {},
      {ViewTerm{}},
      {ScreenTerm{}},
      {ScreenTerm{}, FrustumTerm{}},
      {ViewTerm{}, DistanceTerm{}, FrustumTerm{}},
      {CurvatureTerm{}, ViewTerm{}},
      {BrushTerm{{Dab{.centre = Vec3d(0, 0, 1), .radius = 0.3, .factor = 5}}}}};
  for (const std::vector<DensityTerm>& terms : term_sets) {
    for (const Vec3d& eye : {Vec3d(0, 0, 3), Vec3d(0.8, 0.8, 0.8), Vec3d(20, -30, 10)}) {
      Density density = seen_from(eye, terms);
      density.cameras.push_back(camera_at(Vec3d(2, 1, 0)));
      for (const double pixels : {5.0, 20.0}) {
        const auto points = points_for(density, pixels);
        ASSERT_TRUE(points.ok()) << points.status();
        const double expected = std::clamp(expected_points(*ball(), density, pixels), 1.0, static_cast<double>(kMaxPoints));
        EXPECT_NEAR(static_cast<double>(*points), expected, 1 + 2e-3 * expected) << eye.transpose() << ", " << terms.size();
      }
    }
  }
}

TEST(PointsForPixelError, ScreenPointsStandForAsMuchAsAskedFor) {
  // An orthographic picture of 100 pixels a unit: half the ball covers pi 100^2 of them.
  Density density = seen_from(Vec3d(0, 0, 3), {ScreenTerm{}});
  density.cameras[0].height = 4;
  density.cameras[0].pixels = 400;
  const auto points = points_for(density, 4);
  ASSERT_TRUE(points.ok());
  EXPECT_NEAR(static_cast<double>(*points), 3.1416 * 1e4 / 16, 30) << "a little more for what is seen at a slant";
}

TEST(PointsForPixelError, StaysWithinItsLimits) {
  EXPECT_EQ(*points_for(seen_from(Vec3d(0, 0, 3)), 1e-6), kMaxPoints);
  EXPECT_EQ(*points_for(seen_from(Vec3d(0, 0, 3)), 1e9), 1u);
  Density away = seen_from(Vec3d(0, 0, 3), {});
  away.cameras[0].target = Vec3d(0, 0, 6);
  EXPECT_EQ(*points_for(away, 1), 1u) << "nothing is in the picture";
  using Code = absl::StatusCode;
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(points_for(away, bad).status().code(), Code::kInvalidArgument);
  }
  EXPECT_EQ(points_for({}, 1).status().code(), Code::kInvalidArgument);
  EXPECT_EQ(points_for({ViewTerm{}}, 1).status().code(), Code::kInvalidArgument);
  EXPECT_EQ(points_for(seen_from(Vec3d(0, 0.1, 0)), 1).status().code(), Code::kFailedPrecondition);
}

TEST(ScaledPoints, FallWithTheDistance) {
  const Density density = seen_from(Vec3d(0, 0, 10), {DistanceTerm{.near = 5, .global = true}});
  EXPECT_EQ(scaled_points(density, ball()->box, 1000), 250u);
  EXPECT_EQ(scaled_points(density, ball()->box, 1), 1u);
  EXPECT_EQ(scaled_points({}, ball()->box, 1234), 1234u);
}

}  // namespace
}  // namespace curvecast
