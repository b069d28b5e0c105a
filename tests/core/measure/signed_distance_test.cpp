#include "core/measure/signed_distance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<double> distances(const TriangleMesh& mesh, const std::vector<Vec3d>& points) {
  std::vector<double> found(points.size());
  const absl::StatusOr<SignedDistance> signed_distance = SignedDistance::of(mesh);
  EXPECT_TRUE(signed_distance.ok()) << signed_distance.status();
  if (signed_distance.ok()) {
    const absl::Status status = signed_distance->find(points, found);
    EXPECT_TRUE(status.ok()) << status;
  }
  return found;
}

std::vector<Vec3d> random_places(std::size_t n, double reach, const Vec3d& about = Vec3d::Zero()) {
  std::vector<Vec3d> places(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      places[i][axis] = about[axis] + reach * (2 * random_unit(5, 3 * i + static_cast<std::size_t>(axis)) - 1);
    }
  }
  return places;
}

/// Of the unit cube, exactly.
double of_cube(const Vec3d& p) {
  const Vec3d q = (p - Vec3d::Constant(0.5)).cwiseAbs() - Vec3d::Constant(0.5);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

TEST(SignedDistance, OfACubeIsExactAlsoBesideEdgesAndCorners) {
  std::vector<Vec3d> points = random_places(20'000, 1.5, Vec3d::Constant(0.5));
  // On the diagonals nearest features are corners, edges and the diagonals of faces.
  for (double t = -1.01; t < 2; t += 0.07) {
    points.insert(points.end(), {{t, t, t}, {t, t, 0.5}, {t, 1 - t, t}, {t, 0.5, 0.5}, {0.5, t, 1 + t}, {1 + t, 1 + t, 0.3}});
  }
  const std::vector<double> found = distances(make_mesh(cube()), points);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(found[i], of_cube(points[i]), 1e-12) << points[i].transpose();
}

TEST(SignedDistance, OfABallAndATorusIsNearlyTheirs) {
  const std::vector<Vec3d> points = random_places(5000, 2);
  const std::vector<double> ball = distances(make_mesh(icosphere(5)), points);
  const std::vector<double> ring = distances(make_mesh(torus(200, 100)), points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    EXPECT_NEAR(ball[i], p.norm() - 1, 1e-3);
    EXPECT_NEAR(ring[i], std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.3, 1e-3);
  }
}

TEST(SignedDistance, DoesNotCareWhichWayFacesLook) {
  PolygonSoup soup = torus(30, 20);
  const std::vector<Vec3d> points = random_places(2000, 2);
  const std::vector<double> before = distances(make_mesh(soup), points);
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) std::swap(soup.indices[3 * p], soup.indices[3 * p + 1]);
  const std::vector<double> after = distances(make_mesh(soup), points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(before[i], after[i], 1e-12);
  EXPECT_TRUE(std::any_of(before.begin(), before.end(), [](double d) { return d < 0; }));
}

TEST(SignedDistance, OfShellsWithinEachOtherIsInsideBetweenThem) {
  PolygonSoup inner = icosphere(3, 0.5);
  for (std::size_t p = 0; p < inner.polygon_count(); ++p) std::swap(inner.indices[3 * p], inner.indices[3 * p + 1]);
  const std::vector<double> found = distances(make_mesh(merged(icosphere(3), inner)), {{0.1, 0, 0}, {0, 0.75, 0}, {0, 0, 1.2}});
  EXPECT_GT(found[0], 0.3);
  EXPECT_NEAR(found[1], -0.25, 0.02);
  EXPECT_NEAR(found[2], 0.2, 0.02);
}

TEST(SignedDistance, RefusesOpenMeshesAndStops) {
  const absl::StatusOr<SignedDistance> open = SignedDistance::of(make_mesh(open_cylinder(4, 9)));
  EXPECT_EQ(open.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(open.status().message()), ::testing::HasSubstr("18 edges at borders"));
  const TriangleMesh mesh = make_mesh(icosphere(2));
  const std::atomic<bool> cancel = true;
  const std::vector<Vec3d> points(10, Vec3d::Zero());
  std::vector<double> found(10);
  EXPECT_TRUE(absl::IsCancelled(SignedDistance::of(mesh)->find(points, found, {.cancel = &cancel})));
}

}  // namespace
}  // namespace curvecast
