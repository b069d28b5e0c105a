// Our writer beside Draco's own encoder: the same bytes, whatever the points.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/codec/draco_codec.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"
#include "tests/support/draco_reference.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

const DracoOptions kUnitBall = {.box_min = Vec3d(-1, -1, -1), .box_size = 2};

/// n points at random in a cube around the middle, with random normals, radii and, where asked for, colours.
PointSet random_points(std::size_t n, double half_side = 1, bool has_colours = false) {
  PointSet points;
  std::uint64_t counter = 0;
  const auto random = [&] { return static_cast<float>(2 * random_unit(n, counter++) - 1); };
  const auto random_vector = [&] {
    const float x = random(), y = random();
    return Vec3f(x, y, random());
  };
  for (std::size_t i = 0; i < n; ++i) {
    points.positions.push_back(random_vector() * static_cast<float>(half_side));
    points.normals.push_back(random_vector().normalized());
    points.radii.push_back(std::exp2(20 * random()));
    const auto channel = [&] { return static_cast<std::uint8_t>(128 + 50 * random()); };
    if (has_colours) points.colours.push_back({channel(), channel(), channel(), channel()});
  }
  return points;
}

void expect_equal(const PointSet& points, const DracoOptions& options, const std::string& what) {
  float low = 0, high = 0;
  const absl::StatusOr<std::string> bytes = encode_draco(points, options, &low, &high);
  ASSERT_TRUE(bytes.ok()) << what << ": " << bytes.status();
  const std::string reference = testing::draco_reference(points, options);
  // Not EXPECT_EQ, which would print all of them.
  EXPECT_TRUE(*bytes == reference) << what << ", " << points.size() << " points, " << options.position_bits << " and "
                                   << options.normal_bits << " bits: " << bytes->size() << " bytes, Draco's " << reference.size();
}

TEST(DracoEquality, OfRandomPoints) {
  for (const bool has_colours : {false, true}) {
    for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 255u, 256u, 257u, 12'500u}) {
      for (const int position_bits : {1, 11, 16, 18, 20}) {
        for (const int normal_bits : {2, 8, 10, 16}) {
          DracoOptions options = kUnitBall;
          options.position_bits = position_bits;
          options.normal_bits = normal_bits;
          expect_equal(random_points(n, 1, has_colours), options, "at random");
        }
      }
    }
  }
}

// All places near the middle: see draco_reference().
TEST(DracoEquality, OnTheFinestLattices) {
  for (const std::size_t n : {1u, 2u, 3u, 1000u}) {
    const PointSet points = random_points(n, 1.0 / (1 << 14));
    for (const int bits : {25, 30}) {
      DracoOptions options = kUnitBall;
      options.position_bits = bits;
      options.normal_bits = 12;
      expect_equal(points, options, "fine");
    }
  }
}

TEST(DracoEquality, OfEqualPoints) {
  for (const std::size_t n : {1u, 2u, 3u, 12'500u}) {
    for (const int bits : {1, 11, 16, 20, 30}) {
      PointSet points = random_points(1, 1.0 / (1 << 14), true);  // as above
      points.positions.resize(n, points.positions[0]);
      points.normals.resize(n, points.normals[0]);
      points.radii.resize(n, points.radii[0]);
      points.colours.resize(n, points.colours[0]);
      DracoOptions options = kUnitBall;
      options.position_bits = bits;
      expect_equal(points, options, "equal");
    }
  }
}

TEST(DracoEquality, OfNormalsWhereTheOctahedronFolds) {
  std::vector<Vec3f> folds;
  const float values[] = {-1, -0.5f, -1e-4f, -0.0f, 0, 1e-4f, 0.5f, 1};
  for (const float x : values) {
    for (const float y : values) {
      for (const float z : values) folds.emplace_back(x, y, z);
    }
  }
  PointSet points = random_points(20'000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points.normals[i] = folds[static_cast<std::size_t>(random_unit(4, i) * static_cast<double>(folds.size()))];
  }
  for (const int bits : {2, 3, 4, 8, 10, 16}) {
    DracoOptions options = kUnitBall;
    options.normal_bits = bits;
    expect_equal(points, options, "folds");
  }
}

TEST(DracoEquality, OnTheSidesOfTheBoxAndWithRadiiBelowTheLadder) {
  PointSet points = random_points(1000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int c = 0; c < 3; ++c) points.positions[i][c] = random_unit(6, 3 * i + static_cast<std::size_t>(c)) < 0.5 ? -1 : 1;
    points.radii[i] = i % 2 == 0 ? 0.0f : 1e-30f;
  }
  DracoOptions options = kUnitBall;
  options.radius_max = 4;
  expect_equal(points, options, "sides");
}

/// Where there is neither bound nor order to rely on: all kinds of points, by a function of the index.
TEST(DracoEquality, OfCurves) {
  const std::vector<std::pair<std::string, std::function<Vec3f(double)>>> curves = {
      {"line", [](double t) { return Vec3f(static_cast<float>(t), 0, 0); }},
      {"helix", [](double t) { return Vec3d(std::cos(99 * t), std::sin(99 * t), 2 * t - 1).cast<float>().eval(); }},
      {"saw", [](double t) { return Vec3d(std::fmod(50 * t, 1.0), std::fmod(7 * t, 1.0), t).cast<float>().eval(); }}};
  for (const auto& [name, curve] : curves) {
    for (const std::size_t n : {3u, 1000u, 12'500u}) {
      PointSet points = random_points(n);
      for (std::size_t i = 0; i < n; ++i) {
        points.positions[i] = curve(static_cast<double>(i) / static_cast<double>(n));
        points.radii[i] = 0.25f;
      }
      expect_equal(points, kUnitBall, name);
    }
  }
}

TEST(DracoEquality, OfSurfacesInCurveOrder) {
  const std::string off = testing::to_off(testing::icosphere(4));
  const absl::StatusOr<Preprocessed> done = preprocess({"ball.off", off}, {.points = 12'500});
  ASSERT_TRUE(done.ok()) << done.status();
  const absl::StatusOr<PointSet> points = resample(*done->curve, {.points = 12'500});
  ASSERT_TRUE(points.ok()) << points.status();
  DracoOptions options = {.box_min = Vec3d(-1.25, -1.25, -1.25), .box_size = 2.5};
  for (const int bits : {8, 11, 14}) {
    options.position_bits = bits;
    expect_equal(*points, options, "sphere");
  }
}

// Draco keeps the box as text with six decimals; a small model's lattice would be lost in it.
TEST(DracoEquality, EndsWithTheBoxAsItIs) {
  PointSet points = random_points(100);
  for (Vec3f& p : points.positions) p *= 1e-7f;
  DracoOptions options = {.box_min = Vec3d::Constant(-1e-7), .box_size = 2e-7};
  float low = 0, high = 0;
  const absl::StatusOr<std::string> bytes = encode_draco(points, options, &low, &high);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  struct {
    float corner[3], size;
  } box;
  std::memcpy(&box, bytes->data() + bytes->size() - 2 - sizeof box, sizeof box);
  EXPECT_EQ(box.corner[1], -1e-7f);
  EXPECT_EQ(box.size, 2e-7f);
}

}  // namespace
}  // namespace curvecast
