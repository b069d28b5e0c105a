#include "core/codec/octahedral.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

std::vector<std::uint32_t> symbols_of(const std::vector<Vec3f>& normals, int bits) {
  std::vector<std::uint32_t> symbols(2 * normals.size());
  octahedral_symbols(OctahedralLattice(bits), normals, symbols);
  return symbols;
}

std::vector<Vec3f> random_normals(std::size_t n) {
  std::vector<Vec3f> normals;
  for (std::size_t i = 0; i < n; ++i) {
    const auto random = [&](std::uint64_t k) { return static_cast<float>(2 * random_unit(5, 3 * i + k) - 1); };
    normals.push_back(Vec3f(random(0), random(1), random(2)).normalized());
  }
  return normals;
}

TEST(Octahedral, SymbolsLieBelowTheModulus) {
  for (const int bits : {2, 3, 8, 16, 30}) {
    const OctahedralLattice lattice(bits);
    EXPECT_EQ(lattice.modulus, (1 << bits) - 1);
    EXPECT_EQ(lattice.center, (1 << (bits - 1)) - 1);
    for (const std::uint32_t symbol : symbols_of(random_normals(2000), bits)) {
      ASSERT_LT(symbol, static_cast<std::uint32_t>(lattice.modulus));
    }
  }
}

TEST(Octahedral, ASymbolDependsOnTwoNormalsAlone) {
  const std::vector<Vec3f> normals = random_normals(700);
  const std::vector<std::uint32_t> all = symbols_of(normals, 10);
  for (std::size_t i = 1; i < normals.size(); ++i) {
    const std::vector<std::uint32_t> pair = symbols_of({normals[i - 1], normals[i]}, 10);
    ASSERT_EQ(pair[2], all[2 * i]) << i;
    ASSERT_EQ(pair[3], all[2 * i + 1]) << i;
  }
}

TEST(Octahedral, EqualNormalsAreZeros) {
  for (const Vec3f& normal : random_normals(100)) {
    const std::vector<std::uint32_t> symbols = symbols_of({normal, normal}, 8);
    EXPECT_EQ(symbols[2], 0u);
    EXPECT_EQ(symbols[3], 0u);
  }
}

TEST(Octahedral, WhatHasNoDirectionCountsAsX) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<std::uint32_t> x = symbols_of({Vec3f(1, 0, 0)}, 8);
  for (const Vec3f& none :
       {Vec3f(0, 0, 0), Vec3f(1e-8f, 0, -1e-8f), Vec3f(0, kNaN, 0), Vec3f(0, 0, -kInfinity), Vec3f(kNaN, 1, -1)}) {
    EXPECT_EQ(symbols_of({none}, 8), x) << none.transpose();
  }
}

}  // namespace
}  // namespace curvecast
