#include "core/measure/ball_discrepancy.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numeric>

#include "core/base/random.h"
#include "core/measure/gradient.h"
#include "core/measure/random_surface_points.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using Points = std::vector<Vec3d>;

/// One point at a random place of each cell of a grid over the unit square.
Points stratified(std::size_t side, std::uint64_t seed) {
  Points points;
  const auto n = static_cast<double>(side);
  for (std::size_t i = 0; i < side * side; ++i) {
    points.emplace_back((static_cast<double>(i % side) + random_unit(seed, 2 * i)) / n,
                        (static_cast<double>(i / side) + random_unit(seed, 2 * i + 1)) / n, 0);
  }
  return points;
}

double rms_gradient(const BallDiscrepancy& balls, const std::vector<Points>& sets) {
  std::vector<double> x, y;
  for (const Points& set : sets) {
    x.push_back(static_cast<double>(set.size()));
    y.push_back(balls.of(set).rms);
  }
  return log_log_gradient(x, y);
}

TEST(BallDiscrepancy, SharesOfASphereAreThoseOfItsCaps) {
  // Within a distance r of its points a sphere of radius 1 has the share r^2 / 4, and its farthest point is 2 away: the share is
  // the square of a number that is uniform, one in each fifth of [0, 1].
  const BallDiscrepancy balls(testing::make_mesh(testing::icosphere(5)), {.centres = 500, .radii = 5});
  ASSERT_EQ(balls.shares().size(), 2500u);
  double sum = 0;
  for (std::size_t i = 0; i < balls.shares().size(); ++i) {
    const double root = std::sqrt(balls.shares()[i]);
    EXPECT_GE(root, static_cast<double>(i % 5) / 5 - 0.002);
    EXPECT_LE(root, static_cast<double>(i % 5 + 1) / 5 + 0.002);
    sum += balls.shares()[i];
  }
  EXPECT_NEAR(sum / 2500, 1.0 / 3, 0.01);
}

TEST(BallDiscrepancy, SharesDoNotDependOnTheTriangles) {
  const BallOptions options{.centres = 100, .radii = 3};
  const TriangleMesh coarse = testing::make_mesh(testing::square(2)), fine = testing::make_mesh(testing::square(64));
  // Centres differ, as they are drawn by face, but not what balls there have on average.
  const auto mean = [](const BallDiscrepancy& balls) {
    return std::accumulate(balls.shares().begin(), balls.shares().end(), 0.0) / static_cast<double>(balls.shares().size());
  };
  EXPECT_NEAR(mean(BallDiscrepancy(coarse, options)), mean(BallDiscrepancy(fine, options)), 0.05);
}

TEST(BallDiscrepancy, OfRandomPointsFallsWithTheSquareRootAndIsThatOfRandomPoints) {
  for (const PolygonSoup& soup : {testing::square(8), testing::torus(40, 20)}) {
    const TriangleMesh mesh = testing::make_mesh(soup);
    const BallDiscrepancy balls(mesh, {.centres = 300});
    std::vector<Points> sets;
    double relative = 0;
    for (std::size_t n = 64; n <= 32'768; n *= 2) {
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        sets.push_back(random_surface_points(mesh, n, 1000 * n + seed).positions);
        relative += balls.of(sets.back()).rms_relative / 40;
      }
    }
    EXPECT_NEAR(rms_gradient(balls, sets), -0.5, 0.05);
    EXPECT_NEAR(relative, 1, 0.1);
  }
}

TEST(BallDiscrepancy, OfStratifiedPointsFallsFaster) {
  const BallDiscrepancy balls(testing::make_mesh(testing::square(8)), {.centres = 300});
  std::vector<Points> sets;
  for (std::size_t side = 8; side <= 256; side *= 2) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) sets.push_back(stratified(side, 1000 * side + seed));
  }
  EXPECT_NEAR(rms_gradient(balls, sets), -0.75, 0.03);
}

TEST(BallDiscrepancy, IsThatOfPlainCounting) {
  // The share of n points at one place is all or nothing.
  const BallDiscrepancy balls(testing::make_mesh(testing::torus(20, 12)), {.centres = 50, .radii = 4});
  const Points points(100, Vec3d(9, 9, 9));
  double max = 0, square = 0, random = 0;
  for (const double share : balls.shares()) {
    max = std::max(max, share);
    square += share * share / 200;
    random += share * (1 - share) / 200;
  }
  const Discrepancy found = balls.of(points);
  EXPECT_NEAR(found.max, max, 1e-12);
  EXPECT_NEAR(found.rms, std::sqrt(square), 1e-12);
  EXPECT_NEAR(found.rms_relative, std::sqrt(100 * square / random), 1e-9);
}

TEST(BallDiscrepancy, WeighsFacesWithTheirDensity) {
  const TriangleMesh mesh = testing::make_mesh(testing::square(16));
  std::vector<double> density;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) density.push_back(mesh.positions[mesh.triangles[f][0]].x() < 0.499 ? 0 : 2);
  const SurfacePoints random = random_surface_points(mesh, 4000, 1);
  Points points;
  for (std::size_t i = 0; i < 4000; ++i) {
    if (density[random.faces[i]] > 0) points.push_back(random.positions[i]);
  }
  const BallOptions options{.centres = 200};
  EXPECT_NEAR(BallDiscrepancy(mesh, options, density).of(points).rms_relative, 1, 0.5);
  EXPECT_GT(BallDiscrepancy(mesh, options).of(points).rms_relative, 10);
}

TEST(BallDiscrepancy, IsTheSameForAnyNumberOfThreadsAndOrderAndFollowsItsSeed) {
  const TriangleMesh mesh = testing::make_mesh(testing::torus(20, 12));
  Points points = random_surface_points(mesh, 3000, 1).positions;
  const auto run = [&](int threads, std::uint64_t seed) {
    Discrepancy found;
    tbb::task_arena(threads).execute([&] { found = BallDiscrepancy(mesh, {.centres = 60, .seed = seed}).of(points); });
    return found;
  };
  const Discrepancy one = run(1, 5), four = run(4, 5);
  EXPECT_EQ(one.max, four.max);
  EXPECT_EQ(one.rms, four.rms);
  EXPECT_NE(one.rms, run(1, 6).rms);
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(run(2, 5).rms, one.rms);
}

}  // namespace
}  // namespace curvecast
