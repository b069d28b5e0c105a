#include "server/base/rate_limit.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

TEST(RateLimit, LetsASecondsWorthThroughAndThenKeepsTheRate) {
  RateLimit limit(100);
  auto now = RateLimit::Clock::now();
  int at_once = 0;
  while (limit.take(now) == RateLimit::Clock::duration::zero()) ++at_once;
  EXPECT_NEAR(at_once, 100, 1);
  const auto start = now;
  for (int i = 0; i < 1000; ++i) now += limit.take(now);
  EXPECT_NEAR(duration<double>(now - start).count(), 10, 0.05);
}

TEST(RateLimit, HoldsUpWhoWantsMoreRarely) {
  RateLimit limit(1000);
  auto now = RateLimit::Clock::now();
  int times = 0, waits = 0;
  for (const auto end = now + std::chrono::seconds(10); now < end; ++times) {
    const auto wait = limit.take(now);
    if (wait > RateLimit::Clock::duration::zero()) ++waits;
    now += wait;
  }
  EXPECT_NEAR(times, 11'000, 50);  // the first second's worth at once
  EXPECT_LE(waits, 500);
}

TEST(RateLimit, DoesNotSaveUpMoreThanASecond) {
  RateLimit limit(100);
  const auto later = RateLimit::Clock::now() + std::chrono::hours(1);
  int at_once = 0;
  while (limit.take(later) == RateLimit::Clock::duration::zero()) ++at_once;
  EXPECT_NEAR(at_once, 100, 1);
}

TEST(RateLimit, NeverHoldsUpWhoKeepsWithinIt) {
  RateLimit limit(100);
  auto now = RateLimit::Clock::now();
  for (int i = 0; i < 1000; ++i, now += milliseconds(10)) EXPECT_EQ(limit.take(now), RateLimit::Clock::duration::zero());
}

}  // namespace
}  // namespace curvecast::server
