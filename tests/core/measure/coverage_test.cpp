#include "core/measure/coverage.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/measure/random_surface_points.h"
#include "core/measure/spacing.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

double coverage(const TriangleMesh& mesh, const std::vector<Vec3d>& points) {
  return coverage_radius(mesh, PointCloud(points, bounding_box(mesh)));
}

TEST(Coverage, OfTheHexagonalLattice) {
  // A lattice that goes on beyond the square: the middle of three neighbours is farthest from them.
  const double distance = 0.031;
  std::vector<Vec3d> points;
  for (int y = -3; y < 50; ++y) {
    for (int x = -3; x < 50; ++x) points.emplace_back(distance * (x + 0.5 * (y & 1)), distance * std::numbers::sqrt3 / 2 * y, 0);
  }
  // Each point has the area of a rhombus with two such sides, which gives 2 / sqrt(3) for the theory's unit.
  const double unit = packing_radius(distance * distance * std::numbers::sqrt3 / 2, 1);
  for (const int cells : {1, 7, 100}) {
    const double found = coverage(testing::make_mesh(testing::square(cells)), points) / unit;
    EXPECT_LE(found, 2 / std::numbers::sqrt3 * (1 + 1e-5));
    EXPECT_GE(found, 2 / std::numbers::sqrt3 * (1 - kCoverageTolerance));
  }
}

TEST(Coverage, SeesTheLargestHoleAnywhere) {
  const TriangleMesh mesh = testing::make_mesh(testing::square(20));
  std::vector<Vec3d> points;
  for (int i = 0; i < 10'000; ++i) points.emplace_back(i % 100 / 100.0 + 0.005, i / 100 / 100.0 + 0.005, 0);
  const Vec3d hole(0.313, 0.71, 0);
  std::erase_if(points, [&](const Vec3d& p) { return (p - hole).norm() < 0.05; });
  EXPECT_NEAR(coverage(mesh, points), 0.05, 0.005);
  EXPECT_NEAR(coverage(mesh, {Vec3d(0, 0, 0)}), std::sqrt(2), 0.008);
}

TEST(Coverage, OfRandomPointsIsThatOfAVeryFineSampling) {
  using namespace testing;
  for (const PolygonSoup& soup : {torus(20, 10), cube(), merged(icosphere(3), translated(single_triangle(), {4, 0, 0}))}) {
    const TriangleMesh mesh = make_mesh(soup);
    const std::vector<Vec3d> points = random_surface_points(mesh, 300, 1).positions;
    const double found = coverage(mesh, points);
    double largest = 0;
    for (const Vec3d& p : random_surface_points(mesh, 50'000, 2).positions) {
      double nearest = 1e300;
      for (const Vec3d& q : points) nearest = std::min(nearest, (p - q).norm());
      largest = std::max(largest, nearest);
    }
    EXPECT_GE(found * (1 + kCoverageTolerance), largest);
    EXPECT_LE(found, largest * 1.08);
  }
}

TEST(Coverage, EndsForPointsEverywhereAndForNeedles) {
  using namespace testing;
  // A triangle of almost no area and a point on it: far more points than it has room for.
  const TriangleMesh mesh = make_mesh(soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1e-7, 0}}, {{0, 1, 2}}));
  EXPECT_NEAR(coverage(mesh, {Vec3d(0, 0, 0)}), 1, 0.006);
  const TriangleMesh flat = make_mesh(square(1));
  EXPECT_LT(coverage(flat, random_surface_points(flat, 100'000, 1).positions), 0.02);
}

TEST(Coverage, IsTheSameForAnyNumberOfThreadsAndInAnyUnits) {
  const TriangleMesh mesh = testing::make_mesh(testing::torus(40, 20));
  const std::vector<Vec3d> points = random_surface_points(mesh, 1000, 1).positions;
  double found[2];
  for (int run = 0; run < 2; ++run) tbb::task_arena(run == 0 ? 1 : 4).execute([&] { found[run] = coverage(mesh, points); });
  EXPECT_EQ(found[0], found[1]);
  TriangleMesh large = mesh;
  std::vector<Vec3d> far = points;
  for (Vec3d& p : large.positions) p *= 1e12;
  for (Vec3d& p : far) p *= 1e12;
  EXPECT_NEAR(coverage(large, far), 1e12 * found[0], 1e10);
}

}  // namespace
}  // namespace curvecast
