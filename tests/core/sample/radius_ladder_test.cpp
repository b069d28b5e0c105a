#include "core/sample/radius_ladder.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace curvecast {
namespace {

TEST(RadiusLadder, RoundsUpByLessThanARung) {
  for (const double largest : {1e-20, 0.7, 3e12}) {
    const RadiusLadder ladder(largest);
    for (std::uint64_t i = 0; i < 20'000; ++i) {
      const auto radius = static_cast<float>(largest * std::exp2(-31.4 * random_unit(1, i)));
      const float up = ladder.radius(ladder.rung(radius));
      ASSERT_GE(up, radius * 0.99998f);
      ASSERT_LT(up, radius * 1.4143f);
    }
  }
}

TEST(RadiusLadder, KeepsItsOwnRungs) {
  const RadiusLadder ladder(3.3);
  for (int k = 0; k < RadiusLadder::kRungs; ++k) {
    EXPECT_EQ(ladder.rung(ladder.radius(static_cast<std::uint8_t>(k))), k);
  }
}

TEST(RadiusLadder, EndsAboveAndBelow) {
  const RadiusLadder ladder(2);
  EXPECT_EQ(ladder.rung(2), 0);
  EXPECT_EQ(ladder.rung(5), 0);
  EXPECT_EQ(ladder.rung(1e-30f), RadiusLadder::kRungs - 1);
  EXPECT_EQ(RadiusLadder::below(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(RadiusLadder::below(std::numeric_limits<float>::infinity()), RadiusLadder::kRungs - 1);
}

}  // namespace
}  // namespace curvecast
