#include "client/bench/peers/sample_elimination.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "core/measure/random_surface_points.h"
#include "core/measure/spacing.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

/// As the paper says it, with every weight summed up anew each time.
std::vector<std::uint32_t> brute_force(const std::vector<Vec3d>& points, double area, std::size_t n) {
  const double r_max = packing_radius(area, n);
  const double share = static_cast<double>(n) / static_cast<double>(points.size());
  const double r_min = r_max * (1 - std::pow(share, 1.5)) * 0.65;
  std::vector<std::uint32_t> left;
  for (std::uint32_t i = 0; i < points.size(); ++i) left.push_back(i);
  while (left.size() > n) {
    std::size_t heaviest = 0;
    std::int64_t most = -1;
    for (std::size_t a = 0; a < left.size(); ++a) {
      std::int64_t weight = 0;
      for (std::size_t b = 0; b < left.size(); ++b) {
        const double d = std::max((points[left[a]] - points[left[b]]).norm(), 2 * r_min);
        if (a != b && d < 2 * r_max) weight += std::llround(std::pow(1 - d / (2 * r_max), 8) * 0x1p40);
      }
      if (weight > most) most = weight, heaviest = a;
    }
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(heaviest));
  }
  return left;
}

TEST(SampleElimination, IsThatOfBruteForce) {
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::torus(20, 10));
  const std::vector<Vec3d> points = random_surface_points(mesh, 400, 1).positions;
  const auto rest = eliminate_samples(PointCloud(points, bounding_box(mesh)), surface_area(mesh), 80);
  ASSERT_TRUE(rest.ok()) << rest.status();
  EXPECT_EQ(*rest, brute_force(points, surface_area(mesh), 80));
}

TEST(SampleElimination, LeavesPointsFarApartOnAnyNumberOfThreads) {
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::icosphere(4));
  const std::size_t n = 2000;
  const std::vector<Vec3d> points = random_surface_points(mesh, 5 * n, 2).positions;
  const PointCloud cloud(points, bounding_box(mesh));
  std::vector<std::uint32_t> rest[2];
  for (int run = 0; run < 2; ++run) {
    tbb::task_arena(run == 0 ? 1 : 4).execute([&] { rest[run] = *eliminate_samples(cloud, surface_area(mesh), n); });
  }
  EXPECT_EQ(rest[0], rest[1]);
  ASSERT_EQ(rest[0].size(), n);
  EXPECT_TRUE(std::is_sorted(rest[0].begin(), rest[0].end()));
  std::vector<Vec3d> left;
  for (const std::uint32_t i : rest[0]) left.push_back(points[i]);
  // Yuksel's figure 5 has 0.7 to 0.75 of the largest possible radius; random points have next to nothing.
  const double rho = neighbour_distances(surface_area(mesh), PointCloud(left, bounding_box(mesh))).min;
  EXPECT_GT(rho, 0.6);
  EXPECT_LT(neighbour_distances(surface_area(mesh), PointCloud(std::span(points).first(n), bounding_box(mesh))).min, 0.1);
}

TEST(SampleElimination, TakesPointsAtOnePlaceAndNobodyWhereAllMayStay) {
  const std::vector<Vec3d> same(20, Vec3d(1, 1, 1)), few = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Box3d box;
  for (const Vec3d& p : few) box.extend(p);
  EXPECT_EQ(eliminate_samples(PointCloud(same, box), 1, 3)->size(), 3u);
  EXPECT_EQ(*eliminate_samples(PointCloud(few, box), 1, 3), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(SampleElimination, StopsWhenCancelled) {
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::icosphere(2));
  const std::vector<Vec3d> points = random_surface_points(mesh, 5000, 1).positions;
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_TRUE(absl::IsCancelled(eliminate_samples(PointCloud(points, bounding_box(mesh)), 1, 10, context).status()));
}

}  // namespace
}  // namespace curvecast::cli::bench
