#include "proto/formats/splats.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

/// Where a rotation takes the z axis.
std::array<double, 3> turned_axis(const std::array<float, 4>& rotation) {
  const double x = rotation[0], y = rotation[1], z = rotation[2], w = rotation[3];
  return {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
}

TEST(Splats, LieInTheSurfaceInOrderOfRank) {
  SpherePoints sphere(2000);
  sphere.normals[0] = {0, 0, -1};  // a half turn away
  sphere.normals[1] = {0, 0, 3};
  sphere.normals[2] = {-1e-30F, 0, -1e-30F};
  const auto splats = make_splats(sphere.columns());
  ASSERT_TRUE(splats.ok()) << splats.status();
  ASSERT_EQ(splats->size(), 2000U);
  for (std::size_t i = 0; i < splats->size(); ++i) {
    const std::size_t point = sphere.with_rank(i);
    EXPECT_EQ(splats->positions[i], sphere.positions[point]);
    EXPECT_EQ(splats->colours[i], sphere.colours[point]);
    EXPECT_FLOAT_EQ(splats->widths[i], kSplatWidth * sphere.radii[point]);
    const std::array<double, 3> axis = turned_axis(splats->rotations[i]);
    const std::array<float, 3>& n = splats->normals[i];
    EXPECT_NEAR(std::abs(axis[0] * n[0] + axis[1] * n[1] + axis[2] * n[2]), 1, 1e-6);
    double length = 0;
    for (const float component : splats->rotations[i]) length += double{component} * component;
    EXPECT_NEAR(length, 1, 1e-6);
    EXPECT_GE(splats->rotations[i][3], 0);
  }
}

/// The share of light that Gaussians of discs leave at a place, in front of which they lie.
double transmittance(const std::vector<std::array<double, 2>>& centres, double width, double x, double y) {
  double left = 1;
  for (const auto& [cx, cy] : centres) {
    const double squared = (x - cx) * (x - cx) + (y - cy) * (y - cy);
    left *= 1 - double{kSplatOpacity} * std::exp(-squared / (2 * width * width));
  }
  return left;
}

double dilogarithm(double x) {
  double sum = 0, power = x;
  for (int k = 1; k < 2000; ++k, power *= x) sum += power / k / k;
  return sum;
}

// Points with the density of one in a unit square, one in each square at random: as uneven as a jittered sequence makes them.
TEST(Splats, CloseThePlane) {
  constexpr int kSide = 40;
  std::mt19937 random(7);
  const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<std::array<double, 2>> centres;
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) centres.push_back({x + unit(), y + unit()});
  }
  const double width = kSplatWidth * 1.25;
  double mean = 0, worst = 0;
  constexpr int kPlaces = 4000;
  for (int i = 0; i < kPlaces; ++i) {
    const double left = transmittance(centres, width, 5 + 30 * unit(), 5 + 30 * unit());
    mean += left / kPlaces;
    worst = std::max(worst, left);
  }
  EXPECT_LT(mean, 1.5 / 255) << "not to be seen";
  EXPECT_LT(worst, 0.1);
}

// The formula beside kSplatWidth, at the worst place that it speaks of.
TEST(Splats, LetThroughWhatTheFormulaSays) {
  const double width = kSplatWidth * 1.25;
  for (const double hole : {0.0, 0.9, 1.25}) {
    double sum = 0;
    constexpr int kPoints = 200;
    for (int set = 0; set < kPoints; ++set) {
      std::mt19937 random(static_cast<unsigned>(set));
      const auto unit = [&random] { return static_cast<double>(random()) / 4294967296.0; };
      for (int i = 0; i < 400; ++i) {
        const double x = 20 * unit() - 10, y = 20 * unit() - 10, squared = x * x + y * y;
        if (squared > hole * hole)
          sum += std::log(1 - double{kSplatOpacity} * std::exp(-squared / (2 * width * width))) / kPoints;
      }
    }
    const double formula = -2 * std::numbers::pi * width * width * dilogarithm(std::exp(-hole * hole / (2 * width * width)));
    EXPECT_NEAR(sum, formula, 0.08 * std::abs(formula)) << "a hole of " << hole;
  }
  EXPECT_NEAR(std::exp(-2 * std::numbers::pi * width * width * dilogarithm(std::exp(-0.81 / (2 * width * width)))), 0.014, 0.001);
}

TEST(Splats, WithoutColoursAreShadedByTheirNormals) {
  const SpherePoints sphere(1000);
  PointColumns columns = sphere.columns();
  columns.colours = {};
  const auto splats = make_splats(columns);
  ASSERT_TRUE(splats.ok()) << splats.status();
  int darkest = 255, brightest = 0;
  for (const auto& [red, green, blue] : splats->colours) {
    EXPECT_TRUE(red == green && green == blue);
    darkest = std::min<int>(darkest, red), brightest = std::max<int>(brightest, red);
  }
  EXPECT_LT(darkest, 80);
  EXPECT_GT(darkest, 50);
  EXPECT_GT(brightest, 220);
}

TEST(Splats, HaveNoWidthOfZero) {
  SpherePoints sphere(10);
  sphere.radii.assign(10, 0);
  EXPECT_TRUE(absl::IsInvalidArgument(make_splats(sphere.columns()).status()));
  sphere.radii[3] = 2;
  const auto splats = make_splats(sphere.columns());
  ASSERT_TRUE(splats.ok());
  for (const float width : splats->widths) EXPECT_GE(width, 1e-6F);
  for (float& radius : sphere.radii) radius /= 1e38F;
  const Splats tiny = *make_splats(sphere.columns());
  for (const float width : tiny.widths) EXPECT_TRUE(std::isfinite(std::log(width)));
}

TEST(Splats, AreMadeOfNormalsAndRadii) {
  const SpherePoints sphere(10);
  PointColumns columns = sphere.columns();
  columns.normals = {};
  EXPECT_TRUE(absl::IsInvalidArgument(make_splats(columns).status()));
  columns = sphere.columns();
  columns.radii = {};
  EXPECT_TRUE(absl::IsInvalidArgument(make_splats(columns).status()));
  EXPECT_EQ(make_splats({})->size(), 0U);
}

}  // namespace
}  // namespace curvecast::formats
