#include "core/base/quantised.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/vec.h"

namespace curvecast {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kEndless = std::numeric_limits<float>::infinity();

TEST(Quantised, EveryCodeComesBackAsItself) {
  for (int code = 0; code < 65536; ++code) {
    Unorm16 unit;
    unit.code = static_cast<std::uint16_t>(code);
    EXPECT_EQ(Unorm16(static_cast<float>(unit)).code, code);
  }
  for (int code = -32767; code <= 32767; ++code) {
    Snorm16 component;
    component.code = static_cast<std::int16_t>(code);
    EXPECT_EQ(Snorm16(static_cast<float>(component)).code, code);
  }
}

TEST(Quantised, WhatIsOutOfRangeOrNoNumberHasACode) {
  EXPECT_EQ(Unorm16(2.0f).code, 65535);
  EXPECT_EQ(Unorm16(-kEndless).code, 0);
  EXPECT_EQ(Unorm16(kNone).code, 0);
  EXPECT_EQ(Unorm16(-kNone).code, 0);
  EXPECT_EQ(Snorm16(kEndless).code, 32767);
  EXPECT_EQ(Snorm16(-2.0f).code, -32767);
  EXPECT_EQ(Snorm16(kNone).code, -32767);
  EXPECT_EQ(Snorm16(-kNone).code, -32767);
}

TEST(Quantised, Bfloat16KeepsItsRangeAndEightBits) {
  for (const float value : {0.0f, 1e-30f, 0.3f, -1.7f, 1e30f}) {
    EXPECT_NEAR(static_cast<float>(Bfloat16(value)), value, std::abs(value) / 256);
  }
  EXPECT_LT(static_cast<float>(Bfloat16(kEndless)), kEndless);
}

TEST(Quantised, Direction8KeepsDirectionsToHalfADegree) {
  for (int i = 0; i < 1000; ++i) {
    const double z = 1 - 2 * (i + 0.5) / 1000, r = std::sqrt(1 - z * z);
    const Vec3f direction = Vec3d(r * std::cos(2.4 * i), r * std::sin(2.4 * i), z).cast<float>();
    const Direction8 kept(direction);
    ASSERT_FALSE(kept.is_none());
    ASSERT_GT(kept.unpacked<Vec3f>().normalized().dot(direction), std::cos(0.5 * M_PI / 180)) << direction.transpose();
    ASSERT_EQ(Direction8(kept.unpacked<Vec3f>()), kept);
    ASSERT_EQ(kept.x(), std::round(127 * direction[0]));
    ASSERT_EQ(kept.z(), std::round(127 * direction[2]));
  }
  EXPECT_TRUE(Direction8().is_none());
  EXPECT_TRUE(Direction8(Vec3f(0, 0, 0)).is_none());
  EXPECT_EQ(Direction8(Vec3f(0, -3, 0)).y(), -127);
}

}  // namespace
}  // namespace curvecast
