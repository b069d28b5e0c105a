#include "core/refine/curve_resolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/core/refine/refined.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<float> load_of(const SurfaceCurve& curve, const CurveDemand& demand, double omega = 10) {
  std::vector<float> load(curve.size(), 0);
  EXPECT_TRUE(raise_vertex_loads(curve, demand, omega, load).ok());
  return load;
}

TEST(CurveResolution, ACurveIsFineEnoughForWhatItWasMadeFor) {
  for (const auto& shape : refinable_shapes()) {
    const SurfaceCurve& curve = shape->curve();
    const std::vector<float> load = load_of(curve, {.points = curve.max_points});
    EXPECT_LE(*std::max_element(load.begin(), load.end()), 1.0001);
    const MissingLevels missing = missing_levels(curve, load, 100'000'000);
    EXPECT_EQ(missing.divisor, 1);
    for (const std::uint8_t k : missing.levels) ASSERT_EQ(k, 0);
  }
}

TEST(CurveResolution, AViewOfAnEvenCurveDoesNotCountAsShort) {
  const auto ball = refinable(icosphere(4));
  const CurveDemand view{.points = ball->curve().max_points, .density = seen_from(Vec3d(0, 0, 10))};
  const std::vector<float> load = load_of(ball->curve(), view);
  EXPECT_LT(*std::max_element(load.begin(), load.end()), kMaxVertexLoad);
}

TEST(CurveResolution, LoadsAreOmegaTimesTheExpectedPoints) {
  const auto ball = refinable(icosphere(3));
  const SurfaceCurve& curve = ball->curve();
  const CurveDemand demand{.points = 12'345, .density = seen_from(Vec3d(0, 3, 0))};
  const std::vector<float> load = load_of(curve, demand, 7);
  double sum = 0;
  for (const float x : load) sum += static_cast<double>(x);
  EXPECT_NEAR(sum / (7 * 12'345.0), 1, 1e-5);
  // Two demands: the higher of both everywhere.
  std::vector<float> both = load_of(curve, {.points = 5000}, 7);
  const std::vector<float> even = both;
  ASSERT_TRUE(raise_vertex_loads(curve, demand, 7, both).ok());
  for (std::size_t l = 0; l < both.size(); ++l) ASSERT_EQ(both[l], std::max(load[l], even[l]));
}

TEST(CurveResolution, LevelsAreTheFewestThatAreEnough) {
  const auto ball = refinable(icosphere(3));
  const SurfaceCurve& curve = ball->curve();
  std::vector<float> load(curve.size(), 0.5f);
  const std::vector<std::pair<float, int>> cases = {{0.0f, 0},  {1.0f, 0},  {1.01f, 1}, {3.99f, 1},  {4.0f, 1},
                                                    {4.01f, 2}, {16.0f, 2}, {17.0f, 3}, {1000.0f, 5}};
  for (std::size_t i = 0; i < cases.size(); ++i) load[i] = cases[i].first;
  const MissingLevels missing = missing_levels(curve, load, 1'000'000'000);
  EXPECT_EQ(missing.divisor, 1);
  for (std::size_t i = 0; i < cases.size(); ++i) EXPECT_EQ(missing.levels[i], cases[i].second) << "load " << cases[i].first;
}

TEST(CurveResolution, KeysEndAtTheirLastLevel) {
  auto curve = std::make_shared<SurfaceCurve>(refinable(icosphere(2))->curve());
  curve->level[0] = kMaxLevel;
  curve->level[1] = kMaxLevel - 1;
  std::vector<float> load(curve->size(), 0.0f);
  load[0] = load[1] = load[2] = 100;
  const MissingLevels missing = missing_levels(*curve, load, 1'000'000'000);
  EXPECT_EQ(missing.levels[0], 0);
  EXPECT_EQ(missing.levels[1], 1);
  EXPECT_EQ(missing.levels[2], 4);
}

TEST(CurveResolution, StaysWithinTheLimitAndUsesIt) {
  const auto ball = refinable(icosphere(3));
  const SurfaceCurve& curve = ball->curve();
  std::vector<float> load = load_of(curve, {.points = 3'000'000, .density = seen_from(Vec3d(0, 0, 4))});
  load[7] = std::numeric_limits<float>::infinity();
  for (const std::uint64_t limit :
       {std::uint64_t{0}, std::uint64_t{curve.size()}, std::uint64_t{100'000}, std::uint64_t{1'000'000}}) {
    const MissingLevels missing = missing_levels(curve, load, limit);
    double vertices = 0;
    for (const std::uint8_t k : missing.levels) vertices += std::ldexp(1.0, 2 * k);
    EXPECT_LE(vertices, static_cast<double>(std::max<std::uint64_t>(limit, curve.size())));
    EXPECT_GT(missing.divisor, 1);
  }
  load[7] = 1;
  const MissingLevels missing = missing_levels(curve, load, 1'000'000);
  double vertices = 0;
  for (const std::uint8_t k : missing.levels) vertices += std::ldexp(1.0, 2 * k);
  EXPECT_GT(vertices, 600'000);
}

TEST(CurveResolution, NothingFacingTheEyeAsksForNothing) {
  const auto ball = refinable(icosphere(3));
  const CurveDemand inside{.points = 1000, .density = seen_from(Vec3d(0, 0.1, 0))};
  for (const float x : load_of(ball->curve(), inside)) ASSERT_EQ(x, 0);
}

}  // namespace
}  // namespace curvecast
