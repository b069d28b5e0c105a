#include "core/progressive/group_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;
using Groups = std::vector<std::uint64_t>;

TEST(GroupOrder, IsTotal) {
  constexpr int kLevel = 6;
  Groups groups(GroupOrder::count(kLevel));
  for (std::size_t i = 0; i < groups.size(); ++i) groups[i] = i;
  std::sort(groups.begin(), groups.end(), [](std::uint64_t a, std::uint64_t b) { return GroupOrder::precedes(kLevel, a, b); });
  for (std::size_t i = 1; i < groups.size(); ++i) {
    EXPECT_TRUE(GroupOrder::precedes(kLevel, groups[i - 1], groups[i]));
    EXPECT_FALSE(GroupOrder::precedes(kLevel, groups[i], groups[i - 1]));
  }
}

TEST(GroupOrder, IsAChessboardOnDeepLevels) {
  for (std::uint64_t i = 100; i < 120; ++i) {
    for (std::uint64_t j = 100; j < 120; ++j) {
      EXPECT_EQ(GroupOrder::precedes(kFirstLooseLevel, i, j), i % 2 == 0 && j % 2 == 1);
    }
  }
  // Groups that share a side take turns.
  const int m = GroupOrder::stratum_level(kFirstLooseLevel);
  for (std::uint64_t i = 0; i + 1 < 1000; ++i) {
    const HilbertCell cell = hilbert_cell(i, m);
    EXPECT_EQ((cell.x + cell.y) % 2, i % 2);
  }
}

/// All near groups of a level, from those of the levels before.
std::vector<Groups> near_groups(const GroupOrder& order, int level) {
  std::vector<Groups> near(GroupOrder::count(level));
  const std::vector<Groups> parents = near.size() > 1 ? near_groups(order, level - 1) : std::vector<Groups>{{0}};
  GroupShapes shapes;
  for (std::uint64_t i = 0; i < near.size(); ++i) shapes[{level, i}] = order.find_shape({level, i});
  for (std::size_t i = 0; i < near.size(); ++i) near[i] = order.near({level, i}, parents[i / 4], shapes);
  return near;
}

/// The square that a group is on the flat curve.
Eigen::AlignedBox2d square_of(int level, std::uint64_t group) {
  const int m = GroupOrder::stratum_level(level);
  const HilbertCell cell = hilbert_cell(group, m);
  const double side = std::ldexp(1.0, -m);
  const Vec2d corner(cell.x * side, cell.y * side);
  return {corner, corner + Vec2d(side, side)};
}

TEST(GroupOrder, FindsAllNearGroupsAndFewOthers) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const GroupOrder order(strata, 7);
  for (const int level : {2, 3, 4, 6}) {
    const std::vector<Groups> near = near_groups(order, level);
    const float reach = influence_radius(strata.total_area(), level);
    for (std::uint64_t i = 0; i < near.size(); ++i) {
      const Eigen::AlignedBox2d own = square_of(level, i);
      for (std::uint64_t j = 0; j < near.size(); ++j) {
        const double distance = own.exteriorDistance(square_of(level, j));
        const bool is_found = std::binary_search(near[i].begin(), near[i].end(), j);
        if (distance <= static_cast<double>(reach)) {
          EXPECT_TRUE(is_found) << level << ' ' << i << ' ' << j;
        } else if (distance > 1.5 * static_cast<double>(reach)) {
          EXPECT_FALSE(is_found) << level << ' ' << i << ' ' << j;
        }
      }
    }
  }
}

TEST(GroupOrder, DoesNotDependOnWhatWasMadeReady) {
  const auto curve = flat_curve(7);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  const GroupOrder ready(strata, 7), other(strata, 1);
  EXPECT_EQ(near_groups(ready, 6), near_groups(other, 6));
}

}  // namespace
}  // namespace curvecast
