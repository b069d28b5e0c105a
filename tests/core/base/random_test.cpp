#include "core/base/random.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

namespace curvecast {
namespace {

constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();

TEST(Random, StaysInTheUnitInterval) {
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, kMost}) {
    for (std::uint64_t i = 0; i < 100'000; ++i) {
      const double u = random_unit(seed, i);
      ASSERT_GE(u, 0);
      ASSERT_LT(u, 1);
    }
    EXPECT_LT(random_unit(seed, kMost), 1);
  }
}

TEST(Random, IsTheSameOnEveryMachine) {
  // SplitMix64's first numbers from the seed 0, as published.
  EXPECT_EQ(mix_bits(0x9e3779b97f4a7c15u), 0xe220a8397b1dcdafu);
  EXPECT_EQ(mix_bits(2 * 0x9e3779b97f4a7c15u), 0x6e789e6aa1b965f4u);
  static_assert(random_unit(1, 2) == random_unit(1, 2));
}

TEST(Random, IsUniform) {
  constexpr int kBins = 64;
  constexpr int kDraws = 640'000;
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{42}, kMost}) {
    std::array<int, kBins> bins{};
    for (std::uint64_t i = 0; i < kDraws; ++i) ++bins[static_cast<std::size_t>(kBins * random_unit(seed, i))];
    double chi_square = 0;
    constexpr double kMean = static_cast<double>(kDraws) / kBins;
    for (const int count : bins) chi_square += (count - kMean) * (count - kMean) / kMean;
    EXPECT_LT(chi_square, 63 + 5 * std::sqrt(2 * 63.0)) << seed;
  }
}

TEST(Random, NeighboursInSeedOrCounterAreUnrelated) {
  constexpr int kDraws = 200'000;
  double along_counter = 0, along_seed = 0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    along_counter += (random_unit(7, i) - 0.5) * (random_unit(7, i + 1) - 0.5);
    along_seed += (random_unit(i, 7) - 0.5) * (random_unit(i + 1, 7) - 0.5);
  }
  // Variance of one product is 1/144.
  const double bound = 5 / 12.0 / std::sqrt(static_cast<double>(kDraws));
  EXPECT_LT(std::abs(along_counter / kDraws), bound);
  EXPECT_LT(std::abs(along_seed / kDraws), bound);
}

TEST(Random, SeedsDoNotShareNumbers) {
  std::set<double> seen;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    for (std::uint64_t i = 0; i < 1000; ++i) seen.insert(random_unit(seed, i));
  }
  EXPECT_EQ(seen.size(), 100'000u);
}

TEST(Random, MixingChangesHalfOfTheBits) {
  double changed = 0;
  for (std::uint64_t i = 1; i <= 1000; ++i) {
    for (int bit = 0; bit < 64; ++bit) changed += std::popcount(mix_bits(i) ^ mix_bits(i ^ (std::uint64_t{1} << bit)));
  }
  EXPECT_NEAR(changed / 64'000, 32, 0.5);
}

}  // namespace
}  // namespace curvecast
