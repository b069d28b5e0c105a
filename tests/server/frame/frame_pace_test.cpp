#include "server/frame/frame_pace.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

/// After many frames of a client that takes so long for a point.
std::uint64_t settle(FramePace& pace, const AutomaticBudget& budget, double seconds_per_point) {
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t points = pace.points(budget);
    pace.observe(budget, points, FramePace::Seconds(seconds_per_point * static_cast<double>(points)));
  }
  return pace.points(budget);
}

TEST(FramePace, SettlesWhereFramesTakeTheirTime) {
  for (const double target : {0.02, 0.1, 1.0}) {
    const AutomaticBudget budget{target, 4'000'000};
    for (const double seconds_per_point : {1e-4, 2e-6, 5e-7}) {
      FramePace pace;
      const double took = seconds_per_point * static_cast<double>(settle(pace, budget, seconds_per_point));
      EXPECT_LE(took, std::max(1.25 * target, 500 * seconds_per_point));
      EXPECT_GE(took, std::min(0.6 * target, 4e6 * seconds_per_point));
    }
  }
}

TEST(FramePace, KeepsWithinTheLimitAndStaysWhereItIsGood) {
  FramePace pace;
  const AutomaticBudget budget{0.1, 30'000};
  EXPECT_EQ(settle(pace, budget, 1e-9), 30'000u);
  EXPECT_EQ(settle(pace, {0.1, 7}, 1e-9), 7u);
  const std::uint64_t settled = settle(pace, {0.1, 4'000'000}, 1e-6);
  EXPECT_EQ(settle(pace, {0.1, 4'000'000}, 1.1e-6), settled);
}

TEST(FramePace, FramesFromBeforeAChangeDoNotCount) {
  FramePace pace;
  const AutomaticBudget budget{0.1, 200'000};
  const std::uint64_t first = pace.points(budget);
  for (int i = 0; i < 5; ++i) pace.observe(budget, first, FramePace::Seconds(10));
  EXPECT_EQ(pace.points(budget), first * 2 / 5);
}

}  // namespace
}  // namespace curvecast::server
