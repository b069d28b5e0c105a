#include "core/measure/spacing.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"

namespace curvecast {
namespace {

Box3d box_of(const std::vector<Vec3d>& points) {
  Box3d box;
  for (const Vec3d& p : points) box.extend(p);
  return box;
}

/// Rows of a lattice whose points are all `distance` from their neighbours.
std::vector<Vec3d> hexagonal(int side, double distance, const Vec3d& origin = Vec3d::Zero()) {
  std::vector<Vec3d> points;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      points.push_back(origin + distance * Vec3d(x + 0.5 * (y % 2), std::numbers::sqrt3 / 2 * y, 0));
    }
  }
  return points;
}

double hexagonal_area(int side, double distance) { return side * side * distance * distance * std::numbers::sqrt3 / 2; }

TEST(Spacing, OfTheHexagonalLatticeIsOne) {
  for (const double distance : {1e-9, 1.0, 1e9}) {
    // Far out as well.
    const std::vector<Vec3d> points = hexagonal(40, distance, 1000 * distance * Vec3d(1, 1, 1));
    const NeighbourDistances found = neighbour_distances(hexagonal_area(40, distance), PointCloud(points, box_of(points)));
    EXPECT_NEAR(found.min, 1, 1e-4);
    EXPECT_NEAR(found.mean, 1, 1e-4);
    EXPECT_NEAR(found.max, 1, 1e-4);
  }
}

TEST(Spacing, OfTheSquareLatticeAndOfRandomPoints) {
  std::vector<Vec3d> lattice, random;
  for (int i = 0; i < 10'000; ++i) {
    lattice.emplace_back(i % 100 + 0.5, i / 100 + 0.5, 0);
    random.emplace_back(100 * random_unit(1, 2 * i), 100 * random_unit(1, 2 * i + 1), 0);
  }
  const double unit = 2 * packing_radius(10'000, 10'000);
  EXPECT_NEAR(neighbour_distances(10'000, PointCloud(lattice, box_of(lattice))).min, 1 / unit, 1e-4);
  // The mean distance to the nearest of random points is half that of the square lattice (Clark and Evans, 1954).
  const NeighbourDistances found = neighbour_distances(10'000, PointCloud(random, box_of(random)));
  EXPECT_NEAR(found.mean, 0.5 / unit, 0.02);
  EXPECT_LT(found.min, 0.05);
  EXPECT_GT(found.max, 1);
}

TEST(Spacing, PointsAtOnePlaceHaveNone) {
  std::vector<Vec3d> points = hexagonal(10, 1);
  points.push_back(points[17]);
  EXPECT_EQ(neighbour_distances(1, PointCloud(points, box_of(points))).min, 0);
}

TEST(Spacing, OnOneSideDoesNotSeeTheOther) {
  // Two layers, a tenth of the spacing apart.
  std::vector<Vec3d> points = hexagonal(20, 1);
  std::vector<Vec3f> normals(points.size(), Vec3f(0, 0, 1));
  for (const Vec3d& p : hexagonal(20, 1, {0, 0, -0.1})) points.push_back(p);
  normals.resize(points.size(), Vec3f(0, 0, -1));
  const PointCloud tree(points, box_of(points));
  const double area = 2 * hexagonal_area(20, 1);
  EXPECT_NEAR(neighbour_distances(area, tree).min, 0.1, 1e-4);
  EXPECT_NEAR(neighbour_distances_on_side(area, tree, normals).min, 1, 1e-4);
  EXPECT_NEAR(neighbour_distances_on_side(area, tree, normals).max, 1, 1e-4);
  // Over a right angle points are neighbours.
  std::fill(normals.begin() + 400, normals.end(), Vec3f(1, 0, 0));
  EXPECT_NEAR(neighbour_distances_on_side(area, tree, normals).min, 0.1, 1e-4);
}

TEST(Spacing, OnOneSideLooksPastManyOnTheOther) {
  std::vector<Vec3d> points = {{0, 0, 0}, {1, 0, 0}};
  std::vector<Vec3f> normals(2, Vec3f(0, 0, 1));
  for (int i = 0; i < 30; ++i) {
    points.emplace_back(0.01 * i, 0, -0.1);
    normals.emplace_back(0, 0, -1);
  }
  const PointCloud tree(points, box_of(points));
  const double unit = 2 * packing_radius(1, points.size());
  EXPECT_NEAR(neighbour_distances_on_side(1, tree, normals).max, 1 / unit, 1e-4);
  // Nobody on its side.
  const std::vector<Vec3f> apart = {{0, 0, 1}, {0, 0, -1}};
  const PointCloud pair({points.data(), 2}, box_of(points));
  EXPECT_EQ(neighbour_distances_on_side(1, pair, apart).max, 0);
}

TEST(Spacing, IsTheSameForAnyNumberOfThreads) {
  std::vector<Vec3d> points;
  std::vector<Vec3f> normals;
  for (int i = 0; i < 5000; ++i) {
    points.emplace_back(random_unit(1, 3 * i), random_unit(1, 3 * i + 1), 0.1 * random_unit(1, 3 * i + 2));
    normals.emplace_back(0, 0, i % 2 == 0 ? 1 : -1);
  }
  NeighbourDistances found[2];
  for (int run = 0; run < 2; ++run) {
    tbb::task_arena(run == 0 ? 1 : 4).execute([&] {
      found[run] = neighbour_distances_on_side(1, PointCloud(points, box_of(points)), normals);
    });
  }
  EXPECT_EQ(found[0].min, found[1].min);
  EXPECT_EQ(found[0].mean, found[1].mean);
}

}  // namespace
}  // namespace curvecast
