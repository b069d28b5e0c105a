#include "core/density/distance_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::camera_at;
using testing::seen_from;
using testing::sphere_curve;

std::vector<float> density_of(const SurfaceCurve& curve, const Density& density) {
  std::vector<float> values(curve.size());
  const absl::Status status = evaluate_density(curve, density, values);
  EXPECT_TRUE(status.ok()) << status;
  return values;
}

void expect_distance(const SurfaceCurve& curve, const Vec3d& eye, const DistanceTerm& term, double near) {
  const std::vector<float> values = density_of(curve, seen_from(eye, {term}));
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const double distance = (curve.origin + curve.position(l).cast<double>() - eye).stableNorm();
    const double part = near / std::clamp(distance, near, std::max(near, term.far));
    ASSERT_NEAR(values[l], part * part, 1e-4 * part * part + 1e-30) << "vertex " << l << ", eye " << eye.transpose();
  }
}

TEST(DistanceFactor, FallsWithTheSquareOfTheDistance) {
  const SurfaceCurve curve = sphere_curve(2000);
  for (const Vec3d& eye : {Vec3d(0, 0, 3), Vec3d(-2, 5, 1), Vec3d(0.1, 0.2, 0.3), Vec3d(0, 0, 1e5)}) {
    const Vec3d beside = eye.cwiseMax(Vec3d(-1, -1, -1)).cwiseMin(Vec3d(1, 1, 1));
    const double box = std::max(1e-3 * curve.box.diagonal(), (eye - beside).norm());
    expect_distance(curve, eye, {}, box);
    expect_distance(curve, eye, {.near = 0.5}, 0.5);
    expect_distance(curve, eye, {.near = 2.5, .far = 3.5}, 2.5);
    expect_distance(curve, eye, {.near = 2.5, .far = 2.5}, 2.5);
    expect_distance(curve, eye, {.far = 1e-9}, box);
  }
}

TEST(DistanceFactor, IsRightAtEverySizeAndWhereverTheMeshLies) {
  for (const double radius : {1e-12, 1.0, 2e14}) {
    const Vec3d origin = 1e3 * radius * Vec3d(1, -2, 3);
    const SurfaceCurve curve = sphere_curve(500, radius, origin);
    expect_distance(curve, origin + radius * Vec3d(0, 3, 0), {.near = 1.5 * radius, .far = 3 * radius}, 1.5 * radius);
    expect_distance(curve, origin + radius * Vec3d(0, 0, 1e8), {.near = radius}, radius);
  }
}

TEST(DistanceFactor, IsOneForOrthographicCamerasAndGlobalTerms) {
  const SurfaceCurve curve = sphere_curve(100);
  Density density = seen_from(Vec3d(0, 0, 3), {DistanceTerm{.global = true}});
  for (const float value : density_of(curve, density)) EXPECT_EQ(value, 1);
  density = seen_from(Vec3d(0, 0, 3), {DistanceTerm{}});
  density.cameras[0].height = 2;
  for (const float value : density_of(curve, density)) EXPECT_EQ(value, 1);
}

TEST(PointScale, NeverRisesOnTheWayAway) {
  const Box3d box = {Vec3d(-1, -1, -1), Vec3d(1, 1, 1)};
  for (const DistanceTerm& term : {DistanceTerm{.global = true}, DistanceTerm{.global = true, .fall = DistanceFall::kInverse},
                                   DistanceTerm{.far = 50, .global = true, .fall = DistanceFall::kLinear}}) {
    double before = 1;
    for (double eye = 0.5; eye < 1000; eye *= 1.1) {
      const double scale = point_scale(seen_from(Vec3d(0, 0, eye), {term}), box);
      EXPECT_LE(scale, before) << eye;
      if (eye < box.diagonal()) {
        EXPECT_EQ(scale, 1) << "the mesh fills the picture";
      }
      before = scale;
    }
    EXPECT_LT(before, 0.01);
  }
}

TEST(PointScale, FollowsTheDistanceOfTheBox) {
  const Box3d box = {Vec3d(-1, -1, -1), Vec3d(1, 1, 1)};
  const auto scale = [&](double eye, const DistanceTerm& term) { return point_scale(seen_from(Vec3d(0, 0, eye), {term}), box); };
  EXPECT_EQ(scale(4, {.near = 1}), 1) << "a local term leaves the number alone";
  EXPECT_NEAR(scale(4, {.near = 1, .global = true}), 1.0 / 16, 1e-12);
  EXPECT_NEAR(scale(4, {.near = 1, .far = 2, .global = true}), 0.25, 1e-12);
  EXPECT_EQ(scale(4, {.near = 8, .global = true}), 1);
  EXPECT_NEAR(scale(8, {.near = 2, .global = true, .fall = DistanceFall::kInverse}), 0.25, 1e-12);
  EXPECT_NEAR(scale(8, {.near = 2, .far = 10, .global = true, .fall = DistanceFall::kLinear}), 0.25, 1e-12);
  EXPECT_EQ(scale(1, {.near = 2, .far = 10, .global = true, .fall = DistanceFall::kLinear}), 1);
  EXPECT_EQ(scale(11, {.near = 2, .far = 10, .global = true, .fall = DistanceFall::kLinear}), 0);
  EXPECT_EQ(scale(2, {.near = 2, .far = 2, .global = true, .fall = DistanceFall::kLinear}), 1);
  EXPECT_EQ(scale(3, {.near = 2, .far = 2, .global = true, .fall = DistanceFall::kLinear}), 0);
  EXPECT_EQ(point_scale({}, box), 1);
  Density two = seen_from(Vec3d(0, 0, 10), {DistanceTerm{.near = 1, .global = true}});
  two.cameras.push_back(camera_at(Vec3d(2, 0, 0)));
  EXPECT_NEAR(point_scale(two, box), 0.25, 1e-12) << "the nearest camera counts";
  two.cameras.push_back({.eye = Vec3d(0, 0, 10), .height = 1});
  EXPECT_EQ(point_scale(two, box), 1);
}

}  // namespace
}  // namespace curvecast
