#include "client/lib/draco/symbol_values.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace curvecast::client {
namespace {

using Colour = std::array<std::uint8_t, 3>;

TEST(WrappedValues, ReentersOnTheOtherSide) {
  WrappedValues values(10, 14);
  std::array<float, 256> table;
  std::iota(table.begin(), table.end(), 0.0F);
  // The first differs from 10, which is nearest to zero: +0, +4, +2 (wraps), -1, -3 (wraps).
  const std::vector<std::uint32_t> symbols = {0, 8, 4, 1, 5, 0, 0, 0};
  std::vector<float> radii(5);
  values.to_radii(symbols.data(), table, radii);
  EXPECT_EQ(radii, (std::vector<float>{10, 14, 11, 10, 12}));
  EXPECT_TRUE(values.all_within());
  values.to_radii(std::vector<std::uint32_t>{100, 0, 0, 0}.data(), table, std::span(radii).first(1));
  EXPECT_FALSE(values.all_within());
}

TEST(WrappedValues, GoesOnWhereItCameTo) {
  const std::vector<std::uint32_t> symbols = {2, 4, 6, 2, 4, 6, 2, 4, 6, 0, 0, 0};
  std::vector<Colour> at_once(3), in_parts(3);
  WrappedValues(0, 255).to_colours(symbols.data(), 3, at_once);
  EXPECT_EQ(at_once, (std::vector<Colour>{{1, 2, 3}, {2, 4, 6}, {3, 6, 9}}));
  WrappedValues values(0, 255);
  values.to_colours(symbols.data(), 3, std::span(in_parts).first(1));
  values.to_colours(symbols.data() + 3, 3, std::span(in_parts).last(2));
  EXPECT_EQ(at_once, in_parts);
}

TEST(WrappedValues, PutsPlacesOnTheLattice) {
  const std::vector<std::uint32_t> symbols = {2, 4, 6, 0, 0, 0};
  std::vector<std::array<float, 3>> places(1);
  WrappedValues(0, 7).to_places(symbols.data(), 0.5F, {1, 2, 3}, places);
  EXPECT_EQ(places[0], (std::array<float, 3>{1.5F, 3, 4.5F}));
}

TEST(OctahedralValues, GivesUnitVectorsForAnySymbols) {
  for (const int bits : {2, 5, 12, 30}) {
    const std::uint32_t largest = (1U << bits) - 2;
    std::vector<std::uint32_t> symbols(2000);
    for (std::size_t i = 0; i < symbols.size(); ++i) symbols[i] = static_cast<std::uint32_t>(i * 2654435761U) % (largest + 1);
    std::vector<std::array<float, 3>> normals(1000);
    OctahedralValues values(bits);
    values.to_normals(symbols.data(), normals);
    EXPECT_TRUE(values.all_within());
    for (const auto& [x, y, z] : normals) ASSERT_NEAR(std::sqrt(x * x + y * y + z * z), 1, 1e-6);
    symbols[1] = largest + 1;
    values.to_normals(symbols.data(), normals);
    EXPECT_FALSE(values.all_within());
  }
}

}  // namespace
}  // namespace curvecast::client
