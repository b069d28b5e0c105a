#include "core/density/screen_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/density/density.h"
#include "core/density/view_factor.h"
#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::sphere_curve;

/// Pixels per squared unit, from the definition.
double pixels_at(const Camera& camera, const Vec3d& place, const Vec3d& normal, double near) {
  const CameraAxes axes = axes_of(camera);
  if (camera.is_orthographic()) {
    const double cosine = -axes.forward.dot(normal);
    const double per_length = camera.pixels / camera.height;
    return cosine > 0 ? per_length * per_length * std::max(cosine, kLeastSlant) : 0;
  }
  const Vec3d towards = camera.eye - place;
  const double distance = towards.norm(), cosine = towards.dot(normal) / distance, depth = -towards.dot(axes.forward);
  if (cosine <= 0 || depth <= 0) return 0;
  const double focal = camera.pixels / 2 / std::tan(camera.fov / 2);
  return focal * focal * std::max(cosine, kLeastSlant) * distance / std::pow(std::max(depth, near), 3);
}

void expect_screen(const SurfaceCurve& curve, const std::vector<Camera>& cameras) {
  const Density density({ScreenTerm{}}, cameras);
  std::vector<float> values(curve.size());
  ASSERT_TRUE(evaluate_density(curve, density, values).ok());
  const double unit = ViewFactor(curve, density).pixels();
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const Vec3d place = curve.origin + curve.position(l).cast<double>(), normal = curve.normal(l).cast<double>();
    double expected = 0;
    bool on_edge = false;
    for (const Camera& camera : cameras) {
      expected = std::max(expected, pixels_at(camera, place, normal, kNearPlane * curve.box.diagonal()));
      on_edge = on_edge || std::abs((camera.eye - place).normalized().dot(normal)) < 1e-4;
    }
    if (!on_edge) {
      ASSERT_EQ(values[l] > 0, expected > 0) << l;
    }
    if (!on_edge && expected > 0) {
      ASSERT_NEAR(values[l] * unit / std::min(expected, kMostOnScreen * unit), 1, 1e-3) << l;
    }
    ASSERT_TRUE(values[l] >= 0 && values[l] <= kMostOnScreen);
  }
}

TEST(ScreenFactor, IsTheAreaOnTheScreen) {
  const SurfaceCurve curve = sphere_curve(3000);
  for (const Vec3d& eye : {Vec3d(0, 0, 3), Vec3d(-1, 0.5, 1), Vec3d(1e3, 0, -1e3)}) {
    for (const double fov : {0.1, 1.0, 2.5}) {
      Camera camera = camera_at(eye, Vec3d(0.2, 0.3, 0));
      camera.fov = fov;
      camera.pixels = 777;
      expect_screen(curve, {camera});
      camera.height = 2 * fov;
      expect_screen(curve, {camera});
    }
  }
}

TEST(ScreenFactor, ComparesCamerasByTheirPixels) {
  const SurfaceCurve curve = sphere_curve(3000);
  Camera near = camera_at(Vec3d(0, 0, 2)), far = camera_at(Vec3d(0, 4, 3)), flat = camera_at(Vec3d(3, 0, 1));
  near.pixels = 200;
  far.pixels = 2000;
  flat.height = 4;
  expect_screen(curve, {near, far, flat});
  expect_screen(curve, {far, near});
}

TEST(ScreenFactor, IsFiniteAtEverySizeAndFromEverywhere) {
  for (const double radius : {1e-12, 2e14}) {
    const SurfaceCurve curve = sphere_curve(500, radius);
    expect_screen(curve, {camera_at(radius * Vec3d(0, 0, 3))});
    for (const Vec3d& eye : {Vec3d(0, 0, 1.05), Vec3d(0, 0, 1e9), Vec3d(1e200, 1, 0)}) {
      std::vector<float> values(curve.size());
      const Density density({ScreenTerm{}}, {camera_at(radius * eye)});
      ASSERT_TRUE(evaluate_density(curve, density, values).ok());
      EXPECT_GT(*std::max_element(values.begin(), values.end()), 0) << eye.transpose();
      for (const float value : values) ASSERT_TRUE(value >= 0 && value <= kMostOnScreen);
    }
  }
}

}  // namespace
}  // namespace curvecast
