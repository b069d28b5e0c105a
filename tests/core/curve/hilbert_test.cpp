#include "core/curve/hilbert.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "core/base/random.h"

namespace curvecast {
namespace {

TEST(Hilbert, VisitsEveryCellOnceByStepsOfOne) {
  for (int level = 0; level <= 6; ++level) {
    const std::uint64_t cells = std::uint64_t{1} << 2 * level;
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    HilbertCell before{};
    for (std::uint64_t i = 0; i < cells; ++i) {
      const HilbertCell cell = hilbert_cell(i, level);
      EXPECT_LT(cell.x, 1u << level);
      EXPECT_LT(cell.y, 1u << level);
      EXPECT_TRUE(seen.insert({cell.x, cell.y}).second);
      if (i > 0) {
        const auto dx = static_cast<int>(cell.x) - static_cast<int>(before.x);
        const auto dy = static_cast<int>(cell.y) - static_cast<int>(before.y);
        EXPECT_EQ(std::abs(dx) + std::abs(dy), 1) << "level " << level << ", index " << i;
      }
      before = cell;
    }
  }
}

TEST(Hilbert, GoesFromTheLowerLeftToTheLowerRightCorner) {
  for (int level = 1; level <= kMaxLevel; ++level) {
    const HilbertCell first = hilbert_cell(0, level);
    const HilbertCell last = hilbert_cell((std::uint64_t{1} << 2 * level) - 1, level);
    EXPECT_EQ(first.x, 0u);
    EXPECT_EQ(first.y, 0u);
    EXPECT_EQ(last.x, (1u << level) - 1);
    EXPECT_EQ(last.y, 0u);
  }
}

TEST(Hilbert, IndexIsTheInverseAtEveryLevel) {
  for (int level = 0; level <= kMaxLevel; ++level) {
    for (std::uint64_t i = 0; i < 200; ++i) {
      const std::uint64_t index = mix_bits(i + 1000 * static_cast<std::uint64_t>(level)) & ((std::uint64_t{1} << 2 * level) - 1);
      EXPECT_EQ(hilbert_index(hilbert_cell(index, level), level), index);
    }
  }
}

TEST(Hilbert, DeeperLevelsRefineShallowerOnes) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const std::uint64_t index = mix_bits(i) & ((std::uint64_t{1} << 40) - 1);
    const HilbertCell fine = hilbert_cell(index, 20);
    const HilbertCell coarse = hilbert_cell(index >> 10, 15);
    EXPECT_EQ(fine.x >> 5, coarse.x);
    EXPECT_EQ(fine.y >> 5, coarse.y);
  }
}

}  // namespace
}  // namespace curvecast
