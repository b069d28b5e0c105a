#include "core/progressive/sort_along_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

TEST(SortAlongCurve, SortsByPositionAndKeepsTheOrderOfEquals) {
  std::vector<std::uint64_t> scratch;
  for (const std::size_t n : {0u, 1u, 2u, 100u, 5000u}) {
    std::vector<std::uint64_t> keys;
    for (std::uint64_t i = 0; i < n; ++i) {
      const std::uint64_t position = i % 3 == 0 ? i % 7 : mix_bits(i) >> 32;
      keys.push_back(position << 32 | (n - i));
    }
    std::vector<std::uint64_t> expected = keys;
    std::stable_sort(expected.begin(), expected.end(), [](std::uint64_t a, std::uint64_t b) { return a >> 32 < b >> 32; });
    sort_along_curve(keys, scratch);
    EXPECT_EQ(keys, expected);
  }
}

TEST(SortAlongCurve, TakesItemsAlong) {
  std::vector<std::uint64_t> keys, scratch;
  std::vector<std::uint64_t> positions;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    positions.push_back(mix_bits(i) >> 32);
    keys.push_back(positions.back() << 32 | i);
  }
  std::vector<std::uint64_t> sorted(3);
  sort_along_curve(keys, scratch, positions, sorted);
  std::sort(positions.begin(), positions.end());
  EXPECT_EQ(sorted, positions);
}

}  // namespace
}  // namespace curvecast
