#include "core/density/camera_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;

Box3d box_at(const Vec3d& middle, double radius) {
  Box3d box;
  box.extend(middle - radius * Vec3d(1, 0.5, 0.7));
  box.extend(middle + radius * Vec3d(1, 0.5, 0.7));
  return box;
}

/// Positions in a box, relative to `origin`.
std::vector<Vec3f> positions_in(const Box3d& box, const Vec3d& origin) {
  std::vector<Vec3f> positions;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Vec3d part(random_unit(1, i), random_unit(2, i), random_unit(3, i));
    positions.push_back((box.min + part.cwiseProduct(box.max - box.min) - origin).cast<float>());
  }
  return positions;
}

Vec3f towards_eye(const CameraFrame& frame, const Vec3f& p) {
  return {frame.x - frame.slope * p.x(), frame.y - frame.slope * p.y(), frame.z - frame.slope * p.z()};
}

float value_of(const AffineForm& form, const Vec3f& p) { return form.x * p.x() + form.y * p.y() + form.z * p.z() + form.offset; }

TEST(CameraFrame, KnowsTheDirectionToTheEyeAtEverySizeAndDistance) {
  for (const double radius : {1e-12, 1.0, 2e14}) {
    const Box3d box = box_at(1e2 * radius * Vec3d(1, -2, 3), radius);
    const Vec3d origin = box.min + radius * Vec3d(0.3, 0.2, 0.1);
    for (const double distance : {1.5, 30.0, 1e8, 1e100}) {
      const Vec3d eye = box.center() + radius * distance * Vec3d(0.6, 0.3, -0.8);
      const CameraFrame frame(camera_at(eye, box.center()), origin, box);
      for (const Vec3f& p : positions_in(box, origin)) {
        const Vec3d exact = eye - origin - p.cast<double>();
        const Vec3f found = towards_eye(frame, p);
        EXPECT_TRUE(std::isfinite(found.squaredNorm()));
        EXPECT_LT((found.cast<double>().normalized() - exact.stableNormalized()).norm(), 1e-4) << radius << ' ' << distance;
        if (distance < 1e5) {
          EXPECT_NEAR(double{found.norm()} * frame.unit / exact.norm(), 1, 1e-4);
        }
      }
    }
  }
}

TEST(CameraFrame, AnOrthographicCameraLooksAlongOneDirection) {
  const Box3d box = box_at({0, 0, 0}, 2);
  Camera camera = camera_at({5, 1, 0});
  camera.height = 1;
  const CameraFrame frame(camera, Vec3d::Zero(), box);
  const Vec3d back = -axes_of(camera).forward;
  for (const Vec3f& p : positions_in(box, Vec3d::Zero())) {
    EXPECT_LT((towards_eye(frame, p).cast<double>() - back).norm(), 1e-6);
    EXPECT_EQ(value_of(frame.depth, p), 1);
  }
}

TEST(CameraFrame, SidesAreThePicturesDistances) {
  const Box3d box = box_at({3, 4, 5}, 1);
  const Vec3d origin(2, 4, 5);
  for (const bool is_orthographic : {false, true}) {
    Camera camera = camera_at({6, 5, 4}, box.center());
    camera.fov = 0.2;
    camera.aspect = 1.5;
    camera.height = is_orthographic ? 0.7 : 0;
    const CameraFrame frame(camera, origin, box);
    const CameraAxes axes = axes_of(camera);
    for (const Vec3f& p : positions_in(box, origin)) {
      const Vec3d from_eye = origin + p.cast<double>() - camera.eye;
      const double depth = from_eye.dot(axes.forward), half = is_orthographic ? 0.35 : depth * std::tan(0.1);
      const double upright = std::abs(from_eye.dot(axes.up)), across = std::abs(from_eye.dot(axes.right));
      const double least = std::min(half - upright, 1.5 * half - across);
      if (std::abs(least) < 1e-4) continue;  // on the edge of the picture
      bool is_inside = true;
      for (const AffineForm& side : frame.sides) is_inside = is_inside && value_of(side, p) > 0;
      EXPECT_EQ(is_inside, least > 0);
      if (!is_orthographic) {
        EXPECT_NEAR(double{value_of(frame.depth, p)} * frame.unit, depth, 1e-4);
      }
    }
  }
}

TEST(CameraFrame, BoxDistanceIsFromTheEyeToTheBox) {
  const Box3d box = box_at({0, 0, 0}, 2);
  const auto distance = [&](const Vec3d& eye) {
    const CameraFrame frame(camera_at(eye, {0.1, 0.1, 0.1}), Vec3d::Zero(), box);
    return frame.box_distance * frame.unit;
  };
  EXPECT_EQ(distance({1, 0.5, 0.2}), 0);
  EXPECT_NEAR(distance({5, 0, 0}), 3, 1e-12);
  EXPECT_NEAR(distance({5, 5, 0}), 5, 1e-12);
}

}  // namespace
}  // namespace curvecast
