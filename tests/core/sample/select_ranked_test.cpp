#include "core/sample/select_ranked.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/sample/random.h"

namespace curvecast {
namespace {

constexpr std::size_t kPoints = 2000;

/// The ranks in some order.
std::vector<RankedPoint> shuffled_ranks() {
  std::vector<RankedPoint> points(kPoints);
  for (std::uint32_t i = 0; i < kPoints; ++i) points[i].rank = i;
  for (std::size_t i = kPoints - 1; i > 0; --i) {
    std::swap(points[i].rank, points[static_cast<std::size_t>(random_unit(1, i) * static_cast<double>(i + 1))].rank);
  }
  return points;
}

std::vector<float> random_density(std::uint64_t seed) {
  std::vector<float> density(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) density[i] = i % 5 == 0 ? 0 : static_cast<float>(random_unit(seed, i));
  return density;
}

TEST(SelectRanked, OfAUniformDensityTheLowestRanks) {
  const std::vector<RankedPoint> points = shuffled_ranks();
  const std::vector<float> density(kPoints, 1);
  for (const std::uint64_t n : {1u, 2u, 500u, 2000u}) {
    const auto selection = select_ranked(points, density, n);
    ASSERT_TRUE(selection.ok()) << selection.status();
    ASSERT_EQ(selection->points.size(), n);
    for (const std::uint32_t i : selection->points) EXPECT_LT(points[i].rank, n);
    EXPECT_EQ(selection->scale, static_cast<double>(n));
    EXPECT_EQ(selection->ranks, static_cast<double>(n));
  }
}

TEST(SelectRanked, IsExactAndOfTheLeastNeed) {
  const std::vector<RankedPoint> points = shuffled_ranks();
  const std::vector<float> density = random_density(3);
  const auto selection = select_ranked(points, density, 700);
  ASSERT_TRUE(selection.ok()) << selection.status();
  ASSERT_EQ(selection->points.size(), 700u);
  EXPECT_TRUE(std::is_sorted(selection->points.begin(), selection->points.end()));
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const bool chosen = std::binary_search(selection->points.begin(), selection->points.end(), i);
    const double needed = needed_scale(points[i], density[i]);
    EXPECT_TRUE(chosen ? needed <= selection->scale : needed >= selection->scale);
  }
}

TEST(SelectRanked, FewerPointsAreAmongMore) {
  const std::vector<RankedPoint> points = shuffled_ranks();
  const std::vector<float> density = random_density(3);
  std::vector<std::uint32_t> before;
  for (const std::uint64_t n : {1u, 10u, 11u, 400u, 1600u}) {
    const auto selection = select_ranked(points, density, n);
    ASSERT_TRUE(selection.ok()) << selection.status();
    EXPECT_TRUE(std::includes(selection->points.begin(), selection->points.end(), before.begin(), before.end()));
    before = selection->points;
  }
}

TEST(SelectRanked, SetsOfLesserDensitiesAreSubsets) {
  const std::vector<RankedPoint> points = shuffled_ranks();
  std::vector<std::uint32_t> fewer, more;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::vector<float> lesser = random_density(seed);
    std::vector<float> greater = lesser;
    for (std::size_t i = 0; i < kPoints; ++i) {
      if (i % 3 == 0) greater[i] += static_cast<float>(random_unit(seed + 100, i));
      if (i % 3 == 1) greater[i] = std::nextafter(greater[i], 2.0f);
    }
    const double scale = 3000 * random_unit(7, seed);
    shown_points(points, lesser, scale, fewer);
    shown_points(points, greater, scale, more);
    EXPECT_TRUE(std::includes(more.begin(), more.end(), fewer.begin(), fewer.end()));
    EXPECT_GT(more.size(), fewer.size());
  }
}

TEST(SelectRanked, ShowsWhatItSelects) {
  const std::vector<RankedPoint> points = shuffled_ranks();
  const std::vector<float> density = random_density(9);
  const auto selection = select_ranked(points, density, 300);
  ASSERT_TRUE(selection.ok()) << selection.status();
  std::vector<std::uint32_t> shown;
  shown_points(points, density, selection->scale, shown);
  EXPECT_EQ(shown, selection->points);
}

TEST(SelectRanked, RefusesWhatCannotBe) {
  const std::vector<RankedPoint> points = shuffled_ranks();
  std::vector<float> density(kPoints, 1);
  EXPECT_EQ(select_ranked(points, density, 0).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(select_ranked(points, density, kPoints + 1).status().code(), absl::StatusCode::kOutOfRange);
  for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    density[17] = bad;
    EXPECT_EQ(select_ranked(points, density, 5).status().code(), absl::StatusCode::kInvalidArgument);
  }
  density.assign(kPoints, 0);
  EXPECT_EQ(select_ranked(points, density, 1).status().code(), absl::StatusCode::kOutOfRange);
  std::vector<std::uint32_t> shown;
  shown_points(points, density, 1e30, shown);
  EXPECT_TRUE(shown.empty());
}

}  // namespace
}  // namespace curvecast
