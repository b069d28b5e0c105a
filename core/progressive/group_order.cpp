#include "core/progressive/group_order.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/base/reversed_bits.h"
#include "core/base/simd.h"
#include "core/progressive/candidate_points.h"
#include "core/progressive/fill_free_group.h"

namespace curvecast {
namespace {

/// Returns how far a stratum reaches at most, about, from the place that stands for it.
float margin_of(double total_area, int level) { return 0.75f * lattice_distance(total_area, std::ldexp(1.0, 2 * level)); }

/// Says whether any two places of two groups are no farther apart than `reach`.
CURVECAST_WIDE bool is_near(const GroupShape& a, const GroupShape& b, float reach) {
  const Float8 most = Float8{} + reach * reach;
  Int8 found{};
  for (std::size_t i = 0; i < kGroupStrata; ++i) {
    for (std::size_t j = 0; j < kGroupStrata; j += 8) {
      Float8 x, y, z;
      load_lanes(x, b.x + j);
      load_lanes(y, b.y + j);
      load_lanes(z, b.z + j);
      x -= a.x[i], y -= a.y[i], z -= a.z[i];
      found |= x * x + y * y + z * z <= most;
    }
  }
  std::int32_t any = 0;
  for (std::size_t k = 0; k < 8; ++k) any |= found[k];
  return any != 0;
}

GroupShape shape_of(const CurveStrata& strata, const StratumGroup& group) {
  const int m = GroupOrder::stratum_level(group.level);
  const std::vector<CurvePoint> places = strata.spread_over(m, group.index, kGroupStrata, PointPlaces::kAbout);
  GroupShape shape;
  for (std::size_t i = 0; i < kGroupStrata; ++i) {
    shape.x[i] = places[i].position[0], shape.y[i] = places[i].position[1], shape.z[i] = places[i].position[2];
    shape.box.extend(Vec3f(shape.x[i], shape.y[i], shape.z[i]));
  }
  const Vec3f margin = Vec3f::Constant(margin_of(strata.total_area(), m + kGroupLevels));
  shape.box = Eigen::AlignedBox3f(shape.box.min() - margin, shape.box.max() + margin);
  return shape;
}

}  // namespace

GroupOrder::GroupOrder(const CurveStrata& strata, int levels) : strata_(&strata), shapes_(stratum_level(levels - 1) + 1) {
  for (std::size_t m = 0; m < shapes_.size(); ++m) {
    shapes_[m].resize(std::size_t{1} << 2 * m);
    tbb::parallel_for(std::size_t{0}, shapes_[m].size(), [&](std::size_t i) {
      shapes_[m][i] = shape_of(strata, {static_cast<int>(m) + kGroupLevels, i});
    });
  }
}

float GroupOrder::influence_radius(double total_area, int level) {
  return is_free(level) ? free_influence_radius(total_area, level) : curvecast::influence_radius(total_area, level);
}

bool GroupOrder::precedes(int level, std::uint64_t first, std::uint64_t second) {
  if (level >= kFirstLooseLevel) return first % 2 == 0 && second % 2 == 1;
  const int bits = 2 * stratum_level(level);
  return reversed_bits(first, bits) < reversed_bits(second, bits);
}

GroupShape GroupOrder::find_shape(const StratumGroup& group) const {
  return has_shapes(group.level) ? shapes_[static_cast<std::size_t>(stratum_level(group.level))][group.index]
                                 : shape_of(*strata_, group);
}

const GroupShape& GroupOrder::shape(const StratumGroup& group, const GroupShapes& deep) const {
  return has_shapes(group.level) ? shapes_[static_cast<std::size_t>(stratum_level(group.level))][group.index]
                                 : deep.at({group.level, group.index});
}

std::vector<std::uint64_t> GroupOrder::near(const StratumGroup& group, std::span<const std::uint64_t> near_parent,
                                            const GroupShapes& deep) const {
  if (count(group.level) == 1) return {0};
  const GroupShape& own = shape(group, deep);
  const float reach = influence_radius(strata_->total_area(), group.level);
  const float between_places = reach + 2 * margin_of(strata_->total_area(), group.level);
  std::vector<std::uint64_t> near;
  for (const std::uint64_t parent : near_parent) {
    for (std::uint64_t i = 4 * parent; i < 4 * parent + 4; ++i) {
      const GroupShape& other = shape({group.level, i}, deep);
      if (own.box.squaredExteriorDistance(other.box) > reach * reach) continue;
      if (i == group.index || is_near(own, other, between_places)) near.push_back(i);
    }
  }
  return near;
}

}  // namespace curvecast
