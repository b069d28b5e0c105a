#include "core/density/frustum_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/density/density.h"
#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::sphere_curve;

/// Checks every vertex but those on an edge of the picture. Returns how many are inside.
std::size_t expect_frustum(const SurfaceCurve& curve, const Camera& camera) {
  std::vector<float> values(curve.size());
  EXPECT_TRUE(evaluate_density(curve, Density({FrustumTerm{}}, {camera}), values).ok());
  const CameraAxes axes = axes_of(camera);
  const double near = kNearPlane * curve.box.diagonal();
  std::size_t inside = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const Vec3d p = curve.origin + curve.position(l).cast<double>() - camera.eye;
    const double depth = p.dot(axes.forward);
    const double half = camera.is_orthographic() ? camera.height / 2 : depth * std::tan(camera.fov / 2);
    const double upright = half - std::abs(p.dot(axes.up)), across = half * camera.aspect - std::abs(p.dot(axes.right));
    const double margin = std::min({upright, across, camera.is_orthographic() ? 1e300 : depth - near});
    if (std::abs(margin) < 1e-5 * curve.box.diagonal()) continue;
    EXPECT_EQ(values[l], margin > 0 ? 1 : 0) << "vertex " << l << ", eye " << camera.eye.transpose();
    inside += margin > 0 ? 1 : 0;
  }
  return inside;
}

TEST(FrustumFactor, IsOneInThePictureAndZeroOutside) {
  const SurfaceCurve curve = sphere_curve(5000);
  for (const Vec3d& eye : {Vec3d(0, 0, 3), Vec3d(0.1, 0, 0), Vec3d(0.9, 0.9, 0.9), Vec3d(50, 20, -30)}) {
    for (const double aspect : {0.5, 1.0, 2.0}) {
      for (const double fov : {0.02, 0.3, 1.0, 3.0}) {
        Camera camera = camera_at(eye, Vec3d(0.2, 0.3, 0));
        camera.aspect = aspect;
        camera.fov = fov;
        expect_frustum(curve, camera);
        camera.height = fov;
        const std::size_t inside = expect_frustum(curve, camera);
        if (fov > 0.1) {
          EXPECT_GT(inside, 0u);
        }
      }
    }
  }
}

TEST(FrustumFactor, IsRightFromFarAwayAndAtEverySize) {
  for (const double radius : {1e-12, 1.0, 2e14}) {
    const Vec3d origin = 1e3 * radius * Vec3d(1, -2, 3);
    const SurfaceCurve curve = sphere_curve(2000, radius, origin);
    for (const double distance : {3.0, 1e4, 1e7}) {
      Camera camera = camera_at(origin + distance * radius * Vec3d(1, 0, 0), origin);
      camera.fov = 2 * std::atan(0.5 / distance);  // shows half of its height
      const std::size_t inside = expect_frustum(curve, camera);
      EXPECT_GT(inside, 0u);
      EXPECT_LT(inside, curve.size());
    }
  }
  std::vector<float> values(100);
  const SurfaceCurve curve = sphere_curve(100);
  EXPECT_TRUE(evaluate_density(curve, Density({FrustumTerm{}}, {camera_at(Vec3d(1.5e308, 0, 0))}), values).ok());
  for (const float value : values) EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace curvecast
