#include "core/codec/bit_writer.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

TEST(BitWriter, KeepsNumbersOfAllLengths) {
  for (const std::size_t n : {0u, 1u, 2u, 7u, 1000u}) {
    std::vector<std::pair<std::uint32_t, int>> numbers;
    std::size_t all = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const int length = static_cast<int>(33 * random_unit(1, 2 * i));
      const auto number = static_cast<std::uint32_t>(std::uint64_t{1} << length) - 1;
      numbers.emplace_back(static_cast<std::uint32_t>(random_unit(1, 2 * i + 1) * 4294967295.0) & number, length);
      all += static_cast<std::size_t>(length);
    }
    ByteWriter bytes;
    BitWriter bits(bytes);
    for (const auto& [number, length] : numbers) bits.put(number, length);
    bits.finish();
    const std::string text = std::move(bytes).take();
    ASSERT_EQ(text.size(), (all + 7) / 8);
    std::size_t at = 0;
    for (const auto& [number, length] : numbers) {
      std::uint32_t read = 0;
      for (int k = 0; k < length; ++k, ++at) {
        read |= static_cast<std::uint32_t>(static_cast<unsigned char>(text[at / 8]) >> at % 8 & 1) << k;
      }
      ASSERT_EQ(read, number);
    }
    for (; at < 8 * text.size(); ++at) ASSERT_EQ(static_cast<unsigned char>(text[at / 8]) >> at % 8 & 1, 0);
  }
}

}  // namespace
}  // namespace curvecast
