#include "core/base/reversed_bits.h"

#include <gtest/gtest.h>

namespace curvecast {
namespace {

TEST(ReversedBits, AreReversed) {
  EXPECT_EQ(reversed_bits(0, 0), 0u);
  EXPECT_EQ(reversed_bits(0b1, 1), 0b1u);
  EXPECT_EQ(reversed_bits(0b0011, 4), 0b1100u);
  EXPECT_EQ(reversed_bits(1, 64), std::uint64_t{1} << 63);
  for (std::uint64_t i = 0; i < 1024; ++i) EXPECT_EQ(reversed_bits(reversed_bits(i, 10), 10), i);
}

}  // namespace
}  // namespace curvecast
