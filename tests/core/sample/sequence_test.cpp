#include "core/sample/sequence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/random.h"

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

TEST(Sequence, JitteredIsTheSameOnEveryMachine) {
  for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 7u, 1003u, 65'536u}) {
    for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{99}, std::numeric_limits<std::uint64_t>::max()}) {
      const std::vector<double> q = sequence_of(Sequence::kJittered, seed, n);
      for (std::size_t i = 0; i < n; ++i) {
        const double exact = (static_cast<double>(i) + random_unit(seed, i)) / static_cast<double>(n);
        ASSERT_EQ(q[i], std::min(exact, 1 - 0x1p-53)) << i << " of " << n;
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

/// The sequences that go on without end, by their definition, before they are moved.
double member(Sequence sequence, std::uint64_t i) {
  if (sequence == Sequence::kGoldenRatio) {
    const long double turns = i * ((std::sqrt(5.0L) - 1) / 2);
    return static_cast<double>(turns - std::floor(turns));
  }
  double value = 0, digit = 0.5;
  for (; i > 0; i >>= 1, digit /= 2) value += static_cast<double>(i & 1) * digit;
  return value;
}

constexpr Sequence kEndless[] = {Sequence::kVanDerCorput, Sequence::kGoldenRatio};

TEST(Sequence, EndlessOnesHaveTheirFirstMembersInOrder) {
  for (const Sequence sequence : kEndless) {
    for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 13u, 100u, 1024u, 1025u, 75'025u, 300'000u}) {
      for (const std::uint64_t seed : {0u, 1u, 2u}) {
        const std::vector<double> q = sequence_of(sequence, seed, n);
        ASSERT_TRUE(std::is_sorted(q.begin(), q.end()));
        ASSERT_GE(q.front(), 0);
        ASSERT_LT(q.back(), 1);
        // Which seeds move by how much is theirs: the first member lies at 0 before.
        const double shift = sequence_of(sequence, seed, 1)[0];
        std::vector<double> expected;
        for (std::size_t i = 0; i < n; ++i) {
          const double moved = member(sequence, i) + shift;
          expected.push_back(moved < 1 ? moved : moved - 1);
        }
        std::sort(expected.begin(), expected.end());
        for (std::size_t i = 0; i < n; ++i) ASSERT_NEAR(q[i], expected[i], 1e-9) << i << " of " << n;
      }
    }
  }
}

TEST(Sequence, EndlessOnesOnlyGrow) {
  for (const Sequence sequence : kEndless) {
    std::vector<double> fewer;
    for (const std::size_t n : {1u, 2u, 10u, 1000u, 1500u, 20'000u}) {
      const std::vector<double> more = sequence_of(sequence, 3, n);
      EXPECT_TRUE(std::includes(more.begin(), more.end(), fewer.begin(), fewer.end())) << n;
      fewer = more;
    }
  }
}

TEST(Sequence, EndlessOnesAreSpreadEvenlyAtEveryLength) {
  // The star discrepancy times N grows like the logarithm: log2(N) / 3 + 1 for van der Corput's (Niederreiter, theorem 3.6).
  for (const Sequence sequence : kEndless) {
    for (const std::size_t n : {10u, 100u, 777u, 10'000u, 123'456u}) {
      const std::vector<double> q = sequence_of(sequence, 9, n);
      double most = 0;
      for (std::size_t i = 0; i < n; ++i) {
        most = std::max(most, std::abs(q[i] * static_cast<double>(n) - static_cast<double>(i)));
      }
      // Moved round, a stretch has two ends: twice as much.
      EXPECT_LT(most, 2 * (std::log2(static_cast<double>(n)) / 3 + 1)) << n;
    }
  }
}

TEST(Sequence, WritesNoMoreThanItIsAskedFor) {
  for (const Sequence sequence : {Sequence::kJittered, Sequence::kRegular, Sequence::kVanDerCorput, Sequence::kGoldenRatio}) {
    for (const std::size_t n : {0u, 1u, 2u, 3u, 5u, 8u, 17u, 1000u}) {
      std::vector<double> q(n + 8, -1.0);
      fill_sequence(sequence, 5, std::span(q).subspan(4, n));
      for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(q[i], -1) << n;
      for (std::size_t i = 4; i < n + 4; ++i) EXPECT_GE(q[i], 0) << n;
      for (std::size_t i = n + 4; i < n + 8; ++i) EXPECT_EQ(q[i], -1) << n;
    }
  }
}

}  // namespace
}  // namespace curvecast
