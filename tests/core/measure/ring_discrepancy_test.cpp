#include "core/measure/ring_discrepancy.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/measure/gradient.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using Sets = std::vector<std::vector<std::uint32_t>>;

constexpr int kGrid = 200;  // cells along a side of the square, two triangles each

TriangleMesh square() { return curvecast::testing::make_mesh(curvecast::testing::square(kGrid)); }

/// Face of the square, whose side is 1, at a place.
std::uint32_t face_at(double x, double y) {
  const double u = x * kGrid, v = y * kGrid;
  const auto column = static_cast<std::uint32_t>(u), row = static_cast<std::uint32_t>(v);
  return 2 * (row * kGrid + column) + (v - row > u - column);
}

std::vector<std::uint32_t> random_set(std::size_t n, std::uint64_t seed) {
  std::vector<std::uint32_t> set;
  for (std::size_t i = 0; i < n; ++i) set.push_back(face_at(random_unit(seed, 2 * i), random_unit(seed, 2 * i + 1)));
  return set;
}

/// One sample at a random place of each cell of a grid.
std::vector<std::uint32_t> stratified_set(std::size_t side, std::uint64_t seed) {
  std::vector<std::uint32_t> set;
  const auto n = static_cast<double>(side);
  for (std::size_t i = 0; i < side * side; ++i) {
    const double x = (static_cast<double>(i % side) + random_unit(seed, 2 * i)) / n;
    const double y = (static_cast<double>(i / side) + random_unit(seed, 2 * i + 1)) / n;
    set.push_back(face_at(x, y));
  }
  return set;
}

double rms_gradient(const Sets& sets, const std::vector<Discrepancy>& found) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    x.push_back(static_cast<double>(sets[i].size()));
    y.push_back(found[i].rms);
  }
  return log_log_gradient(x, y);
}

TEST(RingSetSizes, AreThePapersForty) {
  const std::vector<double> sizes = ring_set_sizes(4'000'000);
  ASSERT_EQ(sizes.size(), 40u);
  EXPECT_EQ(sizes.front(), 2);
  EXPECT_EQ(sizes.back(), 1'572'864);
  EXPECT_TRUE(std::is_sorted(sizes.begin(), sizes.end()));
  EXPECT_EQ(ring_set_sizes(13), (std::vector<double>{2, 3, 4, 6, 8, 12}));
}

TEST(RingDiscrepancy, OfRandomSamplesFallsWithTheSquareRoot) {
  Sets sets;
  for (std::size_t n = 64; n <= 16'384; n *= 2) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) sets.push_back(random_set(n, 1000 * n + seed));
  }
  EXPECT_NEAR(rms_gradient(sets, ring_discrepancy(square(), sets, {.regions = 100})), -0.5, 0.08);
}

TEST(RingDiscrepancy, OfStratifiedSamplesFallsFaster) {
  Sets sets;
  for (std::size_t side = 8; side <= 100; side += side / 4) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) sets.push_back(stratified_set(side, 1000 * side + seed));
  }
  EXPECT_NEAR(rms_gradient(sets, ring_discrepancy(square(), sets, {.regions = 100})), -0.75, 0.06);
}

TEST(RingDiscrepancy, IsKnownOnATetrahedron) {
  // One triangle, then all four: a seed with k of n samples differs by |k / n - 1 / 4|, the whole by nothing.
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::tetrahedron());
  const Sets sets = {{0, 1, 2, 3}, {2}, {0, 0, 1, 1, 2, 3, 3, 3}};
  const std::vector<Discrepancy> found = ring_discrepancy(mesh, sets, {.regions = 4'000});
  EXPECT_NEAR(found[0].max, 0, 1e-12);
  EXPECT_NEAR(found[0].rms, 0, 1e-12);
  EXPECT_NEAR(found[1].max, 0.75, 1e-12);
  // Mean square over equally likely seeds, half of which is the ring that is the whole: (0.75^2 + 3 * 0.25^2) / 8.
  EXPECT_NEAR(found[1].rms, std::sqrt(0.75 / 8), 0.02);
  EXPECT_NEAR(found[2].max, 0.125, 1e-12);
}

TEST(RingDiscrepancy, OfComponentsSeesTheirShares) {
  using namespace curvecast::testing;
  const TriangleMesh mesh = make_mesh(merged(tetrahedron(), translated(tetrahedron(), Vec3d(9, 0, 0))));
  // All samples on one component, evenly: every whole component is off by a half.
  const std::vector<Discrepancy> found = ring_discrepancy(mesh, Sets{{0, 1, 2, 3}});
  EXPECT_NEAR(found[0].max, 0.5, 1e-12);
  // Of each seed one ring differs by an eighth, the other by a half.
  EXPECT_NEAR(found[0].rms, std::sqrt((0.125 * 0.125 + 0.25) / 2), 1e-12);
}

TEST(RingDiscrepancy, IsTheSameForAnyNumberOfThreadsAndFollowsItsSeed) {
  const TriangleMesh mesh = square();
  const Sets sets = {random_set(1000, 1), stratified_set(30, 2)};
  tbb::task_arena one(1), four(4);
  const auto run = [&](std::uint64_t seed) { return ring_discrepancy(mesh, sets, {.regions = 20, .seed = seed}); };
  const std::vector<Discrepancy> a = one.execute([&] { return run(7); }), b = four.execute([&] { return run(7); });
  for (std::size_t s = 0; s < sets.size(); ++s) {
    EXPECT_EQ(a[s].max, b[s].max);
    EXPECT_EQ(a[s].rms, b[s].rms);
    EXPECT_NE(a[s].rms, run(8)[s].rms);
    EXPECT_GE(a[s].max, a[s].rms);
  }
}

TEST(RingDiscrepancy, RelativeToRandomIsOneForRandomSamples) {
  Sets sets;
  for (std::uint64_t seed = 0; seed < 60; ++seed) sets.push_back(random_set(500 + 100 * seed, seed));
  double mean_square = 0;
  for (const Discrepancy& found : ring_discrepancy(square(), sets, {.regions = 50})) {
    mean_square += found.rms_relative * found.rms_relative / static_cast<double>(sets.size());
  }
  EXPECT_NEAR(mean_square, 1, 0.2);
}

TEST(RingDiscrepancy, WeighsFacesWithTheirDensity) {
  // A third of the density on one side, and samples to match.
  std::vector<double> density(2 * kGrid * kGrid);
  for (std::size_t f = 0; f < density.size(); ++f) density[f] = f / 2 % kGrid < kGrid / 2 ? 1 : 3;
  std::vector<std::uint32_t> set;
  std::uint64_t counter = 0;
  for (const std::uint32_t f : random_set(20'000, 5)) {
    if (density[f] == 3 || random_unit(6, counter++) < 1.0 / 3) set.push_back(f);
  }
  const TriangleMesh mesh = square();
  const Discrepancy fitting = ring_discrepancy(mesh, Sets{set}, {.regions = 100, .face_density = density})[0];
  const Discrepancy even = ring_discrepancy(mesh, Sets{set}, {.regions = 100})[0];
  EXPECT_LT(fitting.rms_relative, 1.8);
  EXPECT_GT(even.rms, 8 * fitting.rms);
  EXPECT_GT(even.max, 0.15);  // half of the square has a quarter of the samples
}

}  // namespace
}  // namespace curvecast
