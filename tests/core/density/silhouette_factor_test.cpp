#include "core/density/silhouette_factor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using ::testing::Each;
using testing::seen_from;
using testing::sphere_curve;

std::vector<float> density_of(const SurfaceCurve& curve, const Density& terms) {
  std::vector<float> density(curve.size(), -1.0f);
  const absl::Status status = evaluate_density(curve, terms, density);
  EXPECT_TRUE(status.ok()) << status;
  return density;
}

/// Checks the view term against the definition, in double precision, for an eye at `eye`.
void expect_view(const SurfaceCurve& curve, const Vec3d& eye, double s0) {
  const std::vector<float> density = density_of(curve, seen_from(eye, {ViewTerm{.s0 = s0}}));
  std::size_t front = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const Vec3d place = curve.origin + Vec3d(curve.x[l], curve.y[l], curve.z[l]);
    const Vec3d normal(curve.nx[l], curve.ny[l], curve.nz[l]);
    const Vec3d towards = eye - place;
    const double cosine = (towards / towards.cwiseAbs().maxCoeff()).normalized().dot(normal);
    if (std::abs(cosine) < 1e-5) continue;  // either side of the silhouette
    if (cosine > 0) {
      ++front;
      ASSERT_NEAR(density[l], 1 - cosine + s0, 1e-5 * (1 + s0)) << "vertex " << l << ", eye " << eye.transpose();
    } else {
      ASSERT_EQ(density[l], 0.0f) << "vertex " << l << ", eye " << eye.transpose();
    }
  }
  EXPECT_GT(front, 0u) << "eye " << eye.transpose();
  EXPECT_LT(front, curve.size()) << "eye " << eye.transpose();
}

TEST(SilhouetteFactor, FollowsItsDefinition) {
  const SurfaceCurve curve = sphere_curve();
  for (const Vec3d& eye : {Vec3d(0, 0, 3), Vec3d(-2, 5, 1), Vec3d(0.9, 0.9, 0.9), Vec3d(0, -1.01, 0), Vec3d(1e3, 0, -1e3)}) {
    for (const double s0 : {1e-3, 0.1, 2.0}) expect_view(curve, eye, s0);
  }
}

TEST(SilhouetteFactor, IsRightForEyesAsFarAsDoublesGo) {
  const SurfaceCurve curve = sphere_curve();
  for (const double distance : {1e5, 1e7, 1e30, 1e100, 1.5e308}) {
    expect_view(curve, {0, 0, distance}, 0.1);
    expect_view(curve, {-distance, distance, distance}, 0.1);
  }
}

TEST(SilhouetteFactor, IsRightAtEverySizeThatRepairLetsThrough) {
  for (const double radius : {1e-12, 1e-5, 1e5, 1e10, 2e14}) {
    const SurfaceCurve curve = sphere_curve(2000, radius);
    for (const double distance : {1.5, 30.0, 1e8}) expect_view(curve, radius * distance * Vec3d(0.6, 0, -0.8), 0.1);
  }
}

TEST(SilhouetteFactor, TakesTheEyeInAbsoluteCoordinates) {
  const Vec3d origin(1e7, -3e7, 2e7);
  const SurfaceCurve curve = sphere_curve(5000, 1, origin);
  expect_view(curve, origin + Vec3d(2, 1, 0), 0.1);
  const std::vector<float> there = density_of(curve, seen_from(origin + Vec3d(2, 1, 0)));
  EXPECT_EQ(there, density_of(sphere_curve(), seen_from(Vec3d(2, 1, 0))));
}

TEST(SilhouetteFactor, RisesTowardsTheSilhouette) {
  for (const double s0 : {0.05, 0.1, 0.5}) {
    const std::vector<float> density = density_of(sphere_curve(200'000), seen_from(Vec3d(0, 0, 1000), {ViewTerm{.s0 = s0}}));
    float smallest = 1e30f, largest = 0;
    for (const float d : density) {
      if (d > 0) smallest = std::min(smallest, d);
      largest = std::max(largest, d);
    }
    EXPECT_NEAR(largest / smallest, (1 + s0) / s0, 0.05 * (1 + s0) / s0) << s0;
  }
}

TEST(SilhouetteFactor, IsZeroFromInside) {
  EXPECT_THAT(density_of(sphere_curve(), seen_from(Vec3d(0.2, -0.1, 0.3))), Each(0.0f));
}

TEST(SilhouetteFactor, IsPositiveOnAllThatFacesTheEye) {
  // A plane seen squarely from afar: 1 - c vanishes, s0 alone is left.
  SurfaceCurve curve = sphere_curve(100);
  for (std::size_t l = 0; l < curve.size(); ++l) {
    curve.z[l] = 0;
    curve.nx[l] = curve.ny[l] = 0;
    curve.nz[l] = 1;
  }
  for (const double s0 : {1e-3, 1e-6, 1e-9}) {
    const std::vector<float> density = density_of(curve, seen_from(Vec3d(0, 0, 1e30), {ViewTerm{.s0 = s0}}));
    for (const float d : density) ASSERT_NEAR(d / s0, 1, 0.01) << s0;
  }
}

TEST(SilhouetteFactor, IsFiniteForAnEyeOnTheSurface) {
  const SurfaceCurve curve = sphere_curve(100);
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const std::vector<float> density = density_of(curve, seen_from(Vec3d(curve.x[l], curve.y[l], curve.z[l])));
    for (const float d : density) ASSERT_TRUE(std::isfinite(d) && d >= 0);
  }
}

}  // namespace
}  // namespace curvecast
