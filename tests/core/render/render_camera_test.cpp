#include "core/render/render_camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace curvecast {
namespace {

// The points' bounds in the picture, -1 .. 1 in both directions when they are inside.
struct Bounds {
  double min_x = 1e300, max_x = -1e300, min_y = 1e300, max_y = -1e300, nearest = 1e300;
};

Bounds project(const RenderCamera& camera, double aspect, const std::vector<Vec3f>& points) {
  const Vec3d z = (camera.eye - camera.target).normalized();
  const Vec3d x = camera.up.cross(z).normalized();
  const Vec3d y = z.cross(x);
  const double t = std::tan(camera.vertical_fov_degrees * std::numbers::pi / 360);
  Bounds bounds;
  for (const Vec3f& point : points) {
    const Vec3d p = point.cast<double>() - camera.eye;
    const double depth = -p.dot(z);
    bounds.nearest = std::min(bounds.nearest, depth);
    bounds.min_x = std::min(bounds.min_x, p.dot(x) / (depth * t * aspect));
    bounds.max_x = std::max(bounds.max_x, p.dot(x) / (depth * t * aspect));
    bounds.min_y = std::min(bounds.min_y, p.dot(y) / (depth * t));
    bounds.max_y = std::max(bounds.max_y, p.dot(y) / (depth * t));
  }
  return bounds;
}

TEST(FitCameraTest, HoldsEveryPointAndFillsThePicture) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const float scale = std::pow(10.0F, 4 * u(random));
    const Vec3f center = 5 * scale * Vec3f(u(random), u(random), u(random));
    const Vec3f sides = scale * Vec3f(1 + u(random), 1 + u(random), 1 + u(random));
    std::vector<Vec3f> points;
    for (int i = 0; i < 50; ++i) points.push_back(center + sides.cwiseProduct(Vec3f(u(random), u(random), u(random))));
    FitOptions options;
    options.direction = Vec3d(u(random), u(random), u(random));
    options.up = Vec3d(u(random), u(random), u(random));
    options.vertical_fov_degrees = 5 + 50 * (1 + u(random));
    options.aspect = std::exp(u(random));
    options.margin = 0.1;

    const RenderCamera camera = fit_camera(points, options);
    const Bounds bounds = project(camera, options.aspect, points);
    EXPECT_GT(bounds.nearest, 0);
    const double limit = 1 - 2 * options.margin;
    const double tolerance = 1e-3;
    EXPECT_LT(std::max({bounds.max_x, bounds.max_y, -bounds.min_x, -bounds.min_y}), limit + tolerance);
    // One pair of sides touches its margin.
    const bool fills_x = bounds.max_x > limit - tolerance && bounds.min_x < -limit + tolerance;
    const bool fills_y = bounds.max_y > limit - tolerance && bounds.min_y < -limit + tolerance;
    EXPECT_TRUE(fills_x || fills_y) << trial;
  }
}

TEST(FitCameraTest, BoxesAreFramedByTheirCorners) {
  Box3d box;
  std::vector<Vec3f> corners;
  for (const float x : {-1.0F, 2.0F}) {
    for (const float y : {3.0F, 4.0F}) {
      for (const float z : {-7.0F, -5.0F}) {
        corners.emplace_back(x, y, z);
        box.extend(Vec3d(x, y, z));
      }
    }
  }
  EXPECT_TRUE(fit_camera(box).eye.isApprox(fit_camera(corners).eye, 1e-12));
}

TEST(FitCameraTest, DegenerateCloudsStillGiveACamera) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::vector<Vec3f>> clouds = {{},
                                                  {Vec3f(kNan, 0, 0)},
                                                  {Vec3f::Zero()},
                                                  {Vec3f(1e6F, 2, 3)},
                                                  {Vec3f::Zero(), Vec3f(0.55F, 0.35F, 1)},
                                                  {Vec3f(1e-30F, 0, 0)}};
  for (const std::vector<Vec3f>& cloud : clouds) {
    for (const Vec3d& direction : {Vec3d(0, 1, 0), Vec3d(0, 0, 0), Vec3d(0.55, 0.35, 1), Vec3d(0, -1e-200, 0)}) {
      FitOptions options;
      options.direction = direction;
      const RenderCamera camera = fit_camera(cloud, options);
      EXPECT_TRUE(camera.eye.allFinite() && camera.target.allFinite() && camera.up.allFinite());
      EXPECT_GT((camera.eye - camera.target).norm(), 0);
      EXPECT_GT(camera.up.cross((camera.eye - camera.target).normalized()).norm(), 0.5);
    }
  }
  EXPECT_TRUE(fit_camera(Box3d()).eye.allFinite());
}

}  // namespace
}  // namespace curvecast
