#include "core/codec/position_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"
#include "core/density/density.h"

namespace curvecast {
namespace {

constexpr double kBox = 7;  // a side of the box about the origin

/// Where a camera's picture shows a place, in pixels.
Vec3d on_picture(const Camera& camera, const Vec3d& place) {
  const CameraAxes axes = axes_of(camera);
  const Vec3d from_eye = place - camera.eye;
  const double scale = camera.is_orthographic() ? camera.pixels / camera.height
                                                : 0.5 * camera.pixels / std::tan(0.5 * camera.fov) / axes.forward.dot(from_eye);
  return {scale * axes.right.dot(from_eye), scale * axes.up.dot(from_eye), 0};
}

double random(std::uint64_t i, double low, double high) { return low + (high - low) * random_unit(11, i); }

/// A place on the picture, at a distance from the eye.
Vec3d random_place(const Camera& camera, double distance, std::uint64_t seed) {
  const CameraAxes axes = axes_of(camera);
  const double up = camera.is_orthographic() ? 0 : std::tan(0.5 * camera.fov);
  const Vec3d ray = axes.forward + up * (random(seed, -1, 1) * axes.up + camera.aspect * random(seed + 1, -1, 1) * axes.right);
  return camera.eye + distance * ray.normalized();
}

Vec3d rounded(const Vec3d& place, int bits) {
  const double step = kBox / (std::exp2(bits) - 1);
  return (place / step).array().round().matrix() * step;
}

std::vector<Camera> cameras() {
  std::vector<Camera> all;
  for (const double degrees : {10.0, 45.0, 120.0}) {
    for (const double pixels : {200.0, 1080.0, 4320.0}) {
      all.push_back({.eye = Vec3d(0.3, 0.2, 0.9),
                     .target = Vec3d(-1, 0.5, -0.4),
                     .fov = degrees * std::numbers::pi / 180,
                     .aspect = 16.0 / 9,
                     .pixels = pixels});
      all.push_back(all.back());
      all.back().height = kBox / degrees;
    }
  }
  return all;
}

TEST(PositionBits, MoveNoPointByMoreThanAFractionOfAPixel) {
  for (const Camera& camera : cameras()) {
    for (const double distance : {5.0, 0.7, 0.03, 0.002}) {
      const double pixels = pixels_per_length(camera, distance, kBox * std::numbers::sqrt3);
      const int bits = position_bits_for(pixels, kBox);
      double most = 0;
      for (std::uint64_t i = 0; i < 2000; ++i) {
        const Vec3d place = random_place(camera, distance * random(3 * i, 1, 4), 3 * i + 1);
        most = std::max(most, (on_picture(camera, rounded(place, bits)) - on_picture(camera, place)).norm());
      }
      if (bits < kMostPositionBits) {
        EXPECT_LE(most, 1.001 * kMostPixelsMoved) << bits << " bits at " << distance;
      }
      // Nor are there more steps than a bit, the picture's corners and the place that is best for rounding make.
      if (bits > kLeastPositionBits) {
        EXPECT_GT(most, kMostPixelsMoved / 32) << bits << " bits at " << distance;
      }
    }
  }
}

TEST(PositionBits, GrowWithWhatThePictureShows) {
  int before = 0;
  for (double pixels = 1; pixels < 1e12; pixels *= 1.3) {
    const int bits = position_bits_for(pixels, kBox);
    EXPECT_GE(bits, before);
    EXPECT_EQ(bits, position_bits_for(pixels * kBox, 1)) << "depends on the unit";
    before = bits;
  }
  EXPECT_EQ(position_bits_for(0, kBox), kLeastPositionBits);
  EXPECT_EQ(before, kMostPositionBits);
}

TEST(PositionBits, NothingIsNearerThanTheNearPlane) {
  const Camera camera;
  EXPECT_EQ(pixels_per_length(camera, 0, 1), pixels_per_length(camera, kNearPlane, 1));
  EXPECT_GT(pixels_per_length(camera, kNearPlane, 1), pixels_per_length(camera, 2 * kNearPlane, 1));
}

TEST(PositionBits, GrowByOneWhereLengthsAreTwiceAsLarge) {
  for (double pixels = 300; pixels < 1e5; pixels *= 1.7) {
    EXPECT_EQ(position_bits_for(2 * pixels, kBox), position_bits_for(pixels, kBox) + 1) << pixels;
  }
}

}  // namespace
}  // namespace curvecast
