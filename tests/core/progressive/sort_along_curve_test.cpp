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
  // Positions of all of the curve, of a small part of it, and of two parts that the middle of the curve divides.
  for (const int common : {0, 20, 36}) {
    for (const std::uint64_t offset : {std::uint64_t{0}, (std::uint64_t{1} << 63) - (std::uint64_t{1} << (63 - common))}) {
      for (const std::size_t n : {0u, 1u, 2u, 100u, 5000u}) {
        std::vector<std::uint64_t> keys;
        for (std::uint64_t i = 0; i < n; ++i) {
          const std::uint64_t position = i % 3 == 0 ? (i % 7) << kIndexBits : mix_bits(i) >> common;
          keys.push_back(curve_key(offset + position, n - i));
        }
        std::vector<std::uint64_t> expected = keys;
        std::stable_sort(expected.begin(), expected.end(),
                         [](std::uint64_t a, std::uint64_t b) { return a >> kIndexBits < b >> kIndexBits; });
        sort_along_curve(keys, scratch);
        EXPECT_EQ(keys, expected) << common;
      }
    }
  }
}

TEST(SortAlongCurve, TakesItemsAlong) {
  std::vector<std::uint64_t> keys, scratch;
  std::vector<std::uint64_t> positions;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    positions.push_back(mix_bits(i));
    keys.push_back(curve_key(positions.back(), i));
  }
  std::vector<std::uint64_t> sorted(3);
  sort_along_curve(keys, scratch, positions, sorted);
  std::sort(positions.begin(), positions.end());
  EXPECT_EQ(sorted, positions);
}

}  // namespace
}  // namespace curvecast
