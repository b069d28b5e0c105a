#include "core/codec/delta_symbols.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

/// What a decoder makes of symbols.
std::vector<std::int32_t> undone(const std::vector<std::uint32_t>& symbols, std::size_t components, const ValueRange& range) {
  std::vector<std::int32_t> values;
  const std::int64_t length = std::int64_t{range.most} - range.least + 1;
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    const std::int64_t half = symbols[i] / 2;
    std::int64_t value = (i < components ? std::clamp(0, range.least, range.most) : values[i - components]) +
                         (symbols[i] % 2 == 0 ? half : -half - 1);
    if (value < range.least) value += length;
    if (value > range.most) value -= length;
    values.push_back(static_cast<std::int32_t>(value));
  }
  return values;
}

TEST(DeltaSymbols, CanBeUndone) {
  for (const std::int32_t most : {1, 2, 255, 2047, 1 << 20, 1 << 30}) {
    for (const std::size_t points : {1u, 2u, 3u, 9u, 1000u}) {
      for (const std::size_t components : {1u, 2u, 3u}) {
        // From 0 on, on both sides of it, or below.
        const std::int32_t shift = static_cast<std::int32_t>(points % 3) * (most / 2 + 1);
        std::vector<std::int32_t> values;
        for (std::size_t i = 0; i < components * points; ++i) {
          values.push_back(static_cast<std::int32_t>((static_cast<double>(most) + 1) * random_unit(2, i)) - shift);
        }
        const ValueRange range = range_of(values);
        EXPECT_EQ(range.least, *std::min_element(values.begin(), values.end()));
        EXPECT_EQ(range.most, *std::max_element(values.begin(), values.end()));
        std::vector<std::uint32_t> symbols(values.size());
        delta_symbols(values, static_cast<int>(components), range, symbols);
        ASSERT_EQ(undone(symbols, components, range), values) << most << ", " << points << " of " << components;
        for (const std::uint32_t symbol : symbols) ASSERT_LE(symbol, static_cast<std::uint32_t>(range.most - range.least));
      }
    }
  }
}

TEST(DeltaSymbols, AreZeroForEqualValues) {
  const std::vector<std::int32_t> values(30, 77);
  std::vector<std::uint32_t> symbols(30, 1);
  delta_symbols(values, 3, range_of(values), symbols);
  EXPECT_EQ(std::count(symbols.begin(), symbols.end(), 0u), 30);
}

}  // namespace
}  // namespace curvecast
