#include "core/measure/kd_order.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "core/base/random.h"

namespace curvecast {
namespace {

std::vector<Vec3d> noise(std::size_t n) {
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(random_unit(3, 3 * i) - 5, random_unit(3, 3 * i + 1) + 100, random_unit(3, 3 * i + 2));
  }
  return points;
}

TEST(KdOrder, RunsAreEvenAndNoneIsTooLong) {
  for (const std::size_t n : {0, 1, 15, 16, 17, 100, 1000}) {
    const Runs runs(n, 16);
    std::size_t next = 0;
    for (std::size_t run = 0; run < runs.count; ++run) {
      EXPECT_EQ(runs.begin(run), next);
      next = runs.end(run);
      EXPECT_LE(next - runs.begin(run), 16u);
      EXPECT_GE(next - runs.begin(run), n / runs.count);
    }
    EXPECT_EQ(next, n);
  }
}

TEST(KdOrder, RunsAreCompact) {
  for (const std::size_t n : {4096u, 5000u}) {
    const std::vector<Vec3d> points = noise(n);
    const std::vector<std::uint32_t> order = kd_order(points, 16);
    const Runs runs(n, 16);
    double volume = 0;
    for (std::size_t run = 0; run < runs.count; ++run) {
      Box3d box;
      for (std::size_t i = runs.begin(run); i < runs.end(run); ++i) box.extend(points[order[i]]);
      volume += (box.max - box.min).prod();
    }
    EXPECT_LT(volume, 1);  // of the unit cube: they don't overlap
  }
}

TEST(KdOrder, HasEveryPointOnceForAnyNumberOfThreads) {
  std::vector<Vec3d> points = noise(20'000);
  std::fill(points.begin() + 100, points.begin() + 5000, points[50]);
  std::vector<std::uint32_t> order, other;
  tbb::task_arena(1).execute([&] { order = kd_order(points, 4); });
  tbb::task_arena(4).execute([&] { other = kd_order(points, 4); });
  EXPECT_EQ(order, other);
  std::sort(other.begin(), other.end());
  for (std::uint32_t i = 0; i < other.size(); ++i) ASSERT_EQ(other[i], i);
}

TEST(KdOrder, OfNoPoints) { EXPECT_TRUE(kd_order({}, 4).empty()); }

}  // namespace
}  // namespace curvecast
