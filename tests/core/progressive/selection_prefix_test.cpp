#include "core/progressive/selection_prefix.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/random.h"
#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<std::uint64_t> positions_of(const RankSelection& selection) {
  std::vector<std::uint64_t> positions;
  selection.for_each_shown(
      [&](const RankRef& ref, std::size_t) { positions.push_back(selection.chunk(ref).curve_position[ref.point]); });
  std::ranges::sort(positions);
  return positions;
}

TEST(SelectionPrefix, IsWhatASortedListTells) {
  const std::shared_ptr<const RankTree> tree = ball_tree(8);
  RankSelector selector;
  RankSelection selection;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Vec3d eye = Vec3d(std::sin(seed), 0.3, std::cos(seed)) * (1.05 + 3 * random_unit(seed, 0));
    const auto n = static_cast<std::uint64_t>(1 + 30'000 * random_unit(seed, 1));
    selector.select(tree, nullptr, ViewFactor(*ball_curve(), view_from(eye)), n, selection);
    const std::vector<std::uint64_t> shown = positions_of(selection);
    std::vector<std::uint64_t> positions = {0, ~std::uint64_t{0}};
    const auto count = static_cast<std::uint64_t>(2'000 * random_unit(seed, 2));
    for (std::uint64_t i = 0; i < count; ++i) {
      positions.push_back(static_cast<std::uint64_t>(random_unit(seed, 3 + i) * 0x1p64));
      if (i % 2 == 0) positions.push_back(shown[i % shown.size()]);
    }
    std::ranges::sort(positions);
    std::vector<std::uint32_t> before(positions.size());
    count_selected_before(selection, positions, before);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      ASSERT_EQ(before[i], std::ranges::lower_bound(shown, positions[i]) - shown.begin()) << "seed " << seed;
    }
  }
}

TEST(SelectionPrefix, NothingIsBeforeNothing) {
  RankSelection selection;
  std::vector<std::uint32_t> before = {7};
  count_selected_before(selection, std::vector<std::uint64_t>{5}, before);
  EXPECT_EQ(before[0], 0u);
  count_selected_before(selection, {}, {});
}

}  // namespace
}  // namespace curvecast
