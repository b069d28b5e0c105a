#include "core/mesh/weld.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

/// Compares with vertices that are looked up one by one.
void expect_weld(const std::vector<Vec3d>& positions, const std::vector<std::uint32_t>& candidates) {
  const Weld found = weld(positions, candidates);
  std::vector<std::uint32_t> map(positions.size());
  std::iota(map.begin(), map.end(), 0u);
  std::map<std::array<double, 3>, std::uint32_t> first;
  std::uint64_t welded = 0;
  for (const std::uint32_t v : candidates) {
    const Vec3d p = positions[v];
    map[v] = first.emplace(std::array{p.x(), p.y(), p.z()}, v).first->second;
    welded += map[v] != v;
  }
  EXPECT_EQ(found.map, map);
  EXPECT_EQ(found.welded, welded);
}

TEST(Weld, FindsTheFirstAtEachPlace) {
  for (const std::uint64_t places : {1u, 3u, 50u, 4'000u, 1'000'000'000u}) {
    std::vector<Vec3d> positions;
    for (std::uint64_t i = 0; i < 120'000; ++i) {
      const std::uint64_t place = mix_bits(i) % places;
      const auto place_of = [&](std::uint64_t k) { return random_unit(place, k) - 0.5; };
      positions.emplace_back(place_of(0), place_of(1), place_of(2));
    }
    std::vector<std::uint32_t> all(positions.size()), some;
    std::iota(all.begin(), all.end(), 0u);
    std::copy_if(all.begin(), all.end(), std::back_inserter(some), [](std::uint32_t v) { return mix_bits(v) % 3 == 0; });
    expect_weld(positions, all);
    expect_weld(positions, some);
  }
}

TEST(Weld, ZeroHasNoSign) {
  const std::vector<Vec3d> positions = {{0.0, 1, -0.0}, {-0.0, 1, 0.0}, {0.0, -1, 0.0}};
  const Weld found = weld(positions, std::vector<std::uint32_t>{0, 1, 2});
  EXPECT_EQ(found.map, (std::vector<std::uint32_t>{0, 0, 2}));
  EXPECT_EQ(found.welded, 1u);
}

TEST(Weld, NothingIsNothing) {
  EXPECT_TRUE(weld({}, {}).map.empty());
  EXPECT_EQ(weld({{1, 2, 3}, {1, 2, 3}}, {}).map, (std::vector<std::uint32_t>{0, 1}));
}

}  // namespace
}  // namespace curvecast
