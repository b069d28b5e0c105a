#include "core/progressive/group_order.h"

#include <tbb/parallel_for.h>

#include "core/base/reversed_bits.h"

namespace curvecast {

GroupOrder::GroupOrder(const CurveStrata& strata, int levels) : strata_(&strata), boxes_(stratum_level(levels - 1) + 1) {
  const int deepest = static_cast<int>(boxes_.size()) - 1;
  for (int m = deepest; m >= 0; --m) {
    boxes_[m].resize(std::size_t{1} << 2 * m);
    tbb::parallel_for(std::size_t{0}, boxes_[m].size(), [&](std::size_t i) {
      if (m == deepest) {
        boxes_[m][i] = strata.box(m, i);
      } else {
        for (std::size_t child = 4 * i; child < 4 * i + 4; ++child) boxes_[m][i].extend(boxes_[m + 1][child]);
      }
    });
  }
}

bool GroupOrder::precedes(int level, std::uint64_t first, std::uint64_t second) {
  const int bits = 2 * stratum_level(level);
  return reversed_bits(first, bits) < reversed_bits(second, bits);
}

Eigen::AlignedBox3f GroupOrder::box(const StratumGroup& group) const {
  const auto m = static_cast<std::size_t>(stratum_level(group.level));
  return m < boxes_.size() ? boxes_[m][group.index] : strata_->box(static_cast<int>(m), group.index);
}

std::vector<std::uint64_t> GroupOrder::near(const StratumGroup& group, std::span<const std::uint64_t> near_parent) const {
  if (count(group.level) == 1) return {0};
  const Eigen::AlignedBox3f own = box(group);
  const float reach = influence_radius(strata_->total_area(), group.level);
  std::vector<std::uint64_t> near;
  for (const std::uint64_t parent : near_parent) {
    for (std::uint64_t i = 4 * parent; i < 4 * parent + 4; ++i) {
      if (own.squaredExteriorDistance(box({group.level, i})) <= reach * reach) near.push_back(i);
    }
  }
  return near;
}

}  // namespace curvecast
