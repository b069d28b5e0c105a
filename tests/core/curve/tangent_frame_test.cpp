#include "core/curve/tangent_frame.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/quantised.h"
#include "core/base/random.h"

namespace curvecast {
namespace {

Vec3f packed(const Vec3f& normal) { return {Snorm16(normal.x()), Snorm16(normal.y()), Snorm16(normal.z())}; }

float number(std::uint64_t i) { return static_cast<float>(2 * random_unit(3, i) - 1); }

/// Packed unit normals: the axes, what lies close to them, and many others.
std::vector<Vec3f> normals() {
  std::vector<Vec3f> all;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      for (const float tilt : {0.0f, 1e-4f, -1e-4f, 0.01f}) {
        all.push_back(packed((sign * Vec3f::Unit(axis) + tilt * Vec3f::Unit((axis + 1) % 3)).normalized()));
      }
    }
  }
  for (std::uint64_t i = 0; i < 3000; i += 3) {
    const Vec3f n(number(i), number(i + 1), number(i + 2));
    if (n.norm() > 0.1f) all.push_back(packed(n.normalized()));
  }
  return all;
}

/// Between two axes, in radians.
float angle_between(const Vec3f& a, const Vec3f& b) { return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))); }

TEST(TangentFrame, IsOrthonormalAndRightHanded) {
  for (const Vec3f& n : normals()) {
    const TangentFrame frame = tangent_frame(n);
    EXPECT_NEAR(frame.first.norm(), 1, 1e-4);
    EXPECT_NEAR(frame.second.norm(), 1, 1e-4);
    EXPECT_NEAR(frame.first.dot(frame.second), 0, 1e-4);
    EXPECT_NEAR(frame.first.dot(n), 0, 1e-4);
    EXPECT_GT(frame.first.cross(frame.second).dot(n), 0.999f);
  }
}

/// Code of a direction near the tangent plane, of any length and sign.
std::uint16_t pack_direction(const Vec3f& direction, const Vec3f& normal) {
  return pack_axes(axis_tensor(direction), normal.x(), normal.y(), normal.z());
}

TEST(TangentFrame, DirectionsComeBackWithinATenthOfAMilliradian) {
  for (const Vec3f& n : normals()) {
    const Vec3f u = n.unitOrthogonal(), v = n.cross(u);
    for (int i = 0; i < 64; ++i) {
      const float t = 0.1f * static_cast<float>(i);
      const Vec3f direction = std::cos(t) * u + std::sin(t) * v;
      const std::uint16_t code = pack_direction(direction, n);
      const Vec3f back = unpack_direction(code, n);
      EXPECT_LT(angle_between(direction, back), 1e-4f) << n.transpose() << " at " << t;
      EXPECT_NEAR(back.norm(), 1, 1e-6);
      EXPECT_EQ(pack_direction(-direction, n), code);
      EXPECT_EQ(pack_direction(-4 * direction, n), code);
    }
  }
}

TEST(TangentFrame, EveryCodeStandsForItsOwnAngle) {
  for (int code = 0; code < 65536; ++code) {
    const double angle = 2 * std::numbers::pi * code / 65536;
    EXPECT_EQ(pack_axis(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))), code);
  }
  EXPECT_EQ(pack_axis(0, 0), 0);
  EXPECT_EQ(pack_axis(1e-30f, 0), 0);
}

/// Code of the mean of three directions.
std::uint16_t mix(const Vec3f (&directions)[3], const Vec3f& weights, const Vec3f& normal) {
  AxisTensor sum{};
  for (int i = 0; i < 3; ++i) {
    const AxisTensor one = axis_tensor(directions[i]);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weights[i] * one[k];
  }
  return pack_axes(sum, normal.x(), normal.y(), normal.z());
}

TEST(TangentFrame, NoNumberHasACode) {
  // As of a surface whose file was cut while it was read. UndefinedBehaviorSanitizer knows whether it is one.
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kEndless = std::numeric_limits<float>::infinity();
  EXPECT_EQ(pack_axis(kNone, kNone), 0);
  EXPECT_EQ(pack_axis(kNone, 1), 0);
  EXPECT_EQ(pack_axis(-kEndless, kEndless), 0);
  EXPECT_EQ(pack_axes(axis_tensor(Vec3f::Constant(kNone)), 0, 0, 1), 0);
  EXPECT_EQ(pack_axis(1, kEndless), 16384);
}

TEST(TangentFrame, TheMeanOfDirectionsIgnoresTheirSense) {
  const Vec3f n = packed(Vec3f(0.3f, -0.5f, 0.8f).normalized());
  const Vec3f u = n.unitOrthogonal(), v = n.cross(u);
  const auto at = [&](float t) { return Vec3f(std::cos(t) * u + std::sin(t) * v); };
  const Vec3f third = Vec3f::Constant(1.0f / 3);
  for (int senses = 0; senses < 8; ++senses) {
    const auto sense = [&](int i) { return (senses >> i & 1) != 0 ? -1.0f : 1.0f; };
    const Vec3f same[] = {sense(0) * at(1), sense(1) * at(1), sense(2) * at(1)};
    EXPECT_LT(angle_between(unpack_direction(mix(same, third, n), n), at(1)), 1e-4f);
    const Vec3f around[] = {sense(0) * at(0.8f), sense(1) * at(1), sense(2) * at(1.2f)};
    EXPECT_LT(angle_between(unpack_direction(mix(around, third, n), n), at(1)), 1e-4f);
    EXPECT_LT(angle_between(unpack_direction(mix(around, {1, 0, 0}, n), n), at(0.8f)), 1e-4f);
    EXPECT_LT(angle_between(unpack_direction(mix(around, {0.5f, 0.5f, 0}, n), n), at(0.9f)), 1e-4f);
  }
}

}  // namespace
}  // namespace curvecast
