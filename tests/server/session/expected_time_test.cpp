#include "server/session/expected_time.h"

#include <gtest/gtest.h>

#include "core/pipeline/scatter_mesh.h"

namespace curvecast::server {
namespace {

TEST(ExpectedTime, GrowsWithAllThatTakesTime) {
  const auto usual = expected_time(1'000'000, {});
  EXPECT_GT(usual.count(), 0);
  EXPECT_GT(expected_time(2'000'000, {}), usual);
  EXPECT_GT(expected_time(1'000'000, {.points = 1'000'000}), usual);
  EXPECT_GT(expected_time(1'000'000, {.omega = 100}), usual);
  EXPECT_GT(expected_time(1'000'000, {.parameteriser = Parameteriser::kCgal}), usual);
}

TEST(ExpectedTime, OfRemeshingGrowsWithThePoints) {
  EXPECT_GT(expected_remesh_time(1000).count(), 0);
  EXPECT_GT(expected_remesh_time(2000), expected_remesh_time(1000));
}

TEST(ExpectedTime, OfScatteringGrowsWithAllThatTakesTime) {
  const auto usual = expected_scatter_time(1'000'000, {});
  EXPECT_GT(usual.count(), 0);
  EXPECT_LT(usual, expected_time(1'000'000, {})) << "nothing is prepared";
  EXPECT_GT(expected_scatter_time(2'000'000, {}), usual);
  EXPECT_GT(expected_scatter_time(1'000'000, {.points = 1'000'000}), usual);
  EXPECT_GT(expected_scatter_time(1'000'000, {.rounds = 10}), usual);
}

TEST(ExpectedTime, OfTheGreatestIsFinite) {
  EXPECT_LT(expected_time(std::uint64_t{8} << 30, {.points = 4'000'000, .omega = 25}), std::chrono::hours(24));
}

}  // namespace
}  // namespace curvecast::server
