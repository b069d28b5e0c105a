#include "core/sample/sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace curvecast {
namespace {

std::vector<double> sequence_of(Sequence sequence, std::uint64_t seed, std::size_t n) {
  std::vector<double> q(n, -1.0);
  fill_sequence(sequence, seed, q);
  return q;
}

TEST(Sequence, HasOnePointInEveryStratum) {
  for (const Sequence sequence : {Sequence::kJittered, Sequence::kRegular}) {
    for (const std::size_t n : {1u, 2u, 3u, 7u, 1000u, 65'536u, 1'000'003u}) {
      for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{99}, std::numeric_limits<std::uint64_t>::max()}) {
        const std::vector<double> q = sequence_of(sequence, seed, n);
        const auto count = static_cast<double>(n);
        for (std::size_t i = 0; i < n; ++i) {
          ASSERT_GE(q[i], static_cast<double>(i) / count) << i << " of " << n;
          ASSERT_LT(q[i], static_cast<double>(i + 1) / count) << i << " of " << n;
        }
        ASSERT_TRUE(std::is_sorted(q.begin(), q.end()));
        ASSERT_LT(q.back(), 1);
      }
    }
  }
}

TEST(Sequence, JitteredUsesItsWholeStratumEvenly) {
  const std::size_t n = 100'000;
  const std::vector<double> q = sequence_of(Sequence::kJittered, 5, n);
  double sum = 0, square = 0, least = 1, most = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double within = q[i] * static_cast<double>(n) - static_cast<double>(i);
    sum += within;
    square += within * within;
    least = std::min(least, within);
    most = std::max(most, within);
  }
  EXPECT_NEAR(sum / static_cast<double>(n), 1.0 / 2, 0.005);
  EXPECT_NEAR(square / static_cast<double>(n), 1.0 / 3, 0.005);
  EXPECT_LT(least, 1e-3);
  EXPECT_GT(most, 1 - 1e-3);
}

TEST(Sequence, JittersEveryPointOnItsOwn) {
  const std::size_t n = 100'000;
  const std::vector<double> q = sequence_of(Sequence::kJittered, 5, n);
  const auto offset = [&](std::size_t i) { return q[i] * static_cast<double>(n) - static_cast<double>(i) - 0.5; };
  for (const std::size_t lag : {1u, 2u, 3u, 64u, 1024u}) {
    double sum = 0;
    for (std::size_t i = 0; i + lag < n; ++i) sum += 12 * offset(i) * offset(i + lag);
    EXPECT_LT(std::abs(sum / static_cast<double>(n - lag)), 5 / std::sqrt(static_cast<double>(n))) << lag;
  }
}

TEST(Sequence, JitteredFollowsTheSeed) {
  const std::vector<double> q = sequence_of(Sequence::kJittered, 7, 1000);
  EXPECT_EQ(q, sequence_of(Sequence::kJittered, 7, 1000));
  const std::vector<double> other = sequence_of(Sequence::kJittered, 8, 1000);
  int same = 0;
  for (std::size_t i = 0; i < q.size(); ++i) same += q[i] == other[i];
  EXPECT_EQ(same, 0);
}

TEST(Sequence, RegularIsExactAndKnowsNoSeed) {
  for (const std::size_t n : {1u, 3u, 1024u, 99'999u}) {
    const std::vector<double> q = sequence_of(Sequence::kRegular, 1, n);
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(q[i], (static_cast<double>(i) + 0.5) / static_cast<double>(n));
    EXPECT_EQ(q, sequence_of(Sequence::kRegular, 2, n));
  }
}

TEST(Sequence, OfNothingIsNothing) {
  fill_sequence(Sequence::kJittered, 0, {});
  fill_sequence(Sequence::kRegular, 0, {});
}

}  // namespace
}  // namespace curvecast
