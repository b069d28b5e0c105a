#include "core/codec/lattice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

std::vector<Vec3f> random_positions(std::size_t n, const Lattice& lattice) {
  std::vector<Vec3f> positions;
  for (std::size_t i = 0; i < n; ++i) {
    const auto random = [&](std::uint64_t k) { return lattice.size * static_cast<float>(random_unit(3, 3 * i + k)); };
    positions.push_back(lattice.low + Vec3f(random(0), random(1), random(2)));
  }
  return positions;
}

TEST(Lattice, RoundsToTheNearestPoint) {
  for (const int bits : {1, 2, 11, 16, 20}) {
    for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 7u, 101u}) {
      const Lattice lattice{.low = Vec3f(-3, 1, 0.5f), .size = 4, .bits = bits};
      const std::vector<Vec3f> positions = random_positions(n, lattice);
      std::vector<std::int32_t> coordinates(3 * n, -1);
      ASSERT_TRUE(to_lattice(lattice, positions, coordinates).ok());
      const double step = lattice.size / (std::exp2(bits) - 1);
      for (std::size_t i = 0; i < 3 * n; ++i) {
        const auto c = static_cast<int>(i % 3);
        ASSERT_GE(coordinates[i], 0);
        ASSERT_LT(coordinates[i], 1 << bits);
        ASSERT_NEAR(lattice.low[c] + step * coordinates[i], positions[i / 3][c], 0.5 * step + 1e-6);
      }
    }
  }
}

// A box a million times as large as the places of interest, which lie about (0, 0, 0), on both sides.
TEST(Lattice, CountsFromACentreAsFinelyAsFloatsAreThere) {
  for (const int bits : {11, 23, 30}) {
    const Lattice lattice{.low = Vec3f(-0.25e6f, -0.5e6f, -0.75e6f), .size = 1e6f, .bits = bits, .is_centred = true};
    const double step = 1e6 / (std::exp2(bits) - 1);
    std::vector<Vec3f> positions;
    for (std::size_t i = 0; i < 1001; ++i) {
      const auto random = [&](std::uint64_t k) { return static_cast<float>(200 * step * (random_unit(4, 3 * i + k) - 0.5)); };
      positions.emplace_back(random(0), random(1), random(2));
    }
    std::vector<std::int32_t> coordinates(3 * positions.size());
    ASSERT_TRUE(to_lattice(lattice, positions, coordinates).ok());
    std::int32_t least = 0, most = 0;
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
      const double x = positions[i / 3][static_cast<int>(i % 3)];
      ASSERT_NEAR(step * coordinates[i], x, 0.5001 * step);
      least = std::min(least, coordinates[i]), most = std::max(most, coordinates[i]);
    }
    EXPECT_LT(least, -90);
    EXPECT_GT(most, 90);
    // To the ends of the box, and no farther.
    const std::vector<Vec3f> corners = {lattice.low, lattice.low + Vec3f::Constant(lattice.size)};
    ASSERT_TRUE(to_lattice(lattice, corners, std::span(coordinates).first(6)).ok());
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(coordinates[i] / (corners[i / 3][static_cast<int>(i % 3)] / step), 1, 1e-3);
    }
    EXPECT_FALSE(to_lattice(lattice, std::vector<Vec3f>{{0.8e6f, 0, 0}}, coordinates).ok());
  }
}

TEST(Lattice, PutsWhatIsJustOutsideOnTheSide) {
  const Lattice lattice{.low = Vec3f(-1, -1, -1), .size = 2, .bits = 8};
  std::vector<std::int32_t> coordinates(6);
  ASSERT_TRUE(to_lattice(lattice, std::vector<Vec3f>{{-1.001f, 0, 1.001f}, {1, -1, 1}}, coordinates).ok());
  EXPECT_EQ(coordinates, (std::vector<std::int32_t>{0, 128, 255, 255, 0, 255}));
}

TEST(Lattice, SaysWhichPointLiesOutside) {
  const Lattice lattice{.low = Vec3f(-1, -1, -1), .size = 2, .bits = 11};
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (const std::size_t n : {1u, 4u, 6u, 8u, 11u}) {
    for (std::size_t bad = 0; bad < n; ++bad) {
      for (const float outside : {1.01f, -1.01f, 1e38f, -1e38f, kInfinity, -kInfinity, kNaN}) {
        std::vector<Vec3f> positions(n, Vec3f::Zero());
        positions[bad][static_cast<int>(bad % 3)] = outside;
        std::vector<std::int32_t> coordinates(3 * n);
        const absl::Status status = to_lattice(lattice, positions, coordinates);
        EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << outside;
        EXPECT_THAT(std::string(status.message()), HasSubstr("point " + std::to_string(bad) + " ")) << outside;
      }
    }
  }
}

TEST(Lattice, StaysWithinRangeWhereFloatsAreCoarserThanTheBox) {
  const Lattice lattice{.low = Vec3f::Constant(1e8f), .size = 5, .bits = 30};
  ASSERT_TRUE(check_lattice(lattice).ok());
  std::vector<std::int32_t> coordinates(3);
  ASSERT_TRUE(to_lattice(lattice, std::vector<Vec3f>{Vec3f::Constant(1e8f + 8)}, coordinates).ok());
  for (const std::int32_t c : coordinates) EXPECT_LE(c, 1 << 30);
}

TEST(Lattice, MustHaveAFiniteNumberOfSteps) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(check_lattice({.size = 1e-6f, .bits = 30}).ok());
  for (const float size : {0.0f, -1.0f, kInfinity, 1e-42f}) EXPECT_FALSE(check_lattice({.size = size, .bits = 30}).ok()) << size;
  EXPECT_FALSE(check_lattice({.low = Vec3f(0, kInfinity, 0)}).ok());
}

}  // namespace
}  // namespace curvecast
