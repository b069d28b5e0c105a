#include "core/progressive/progressive.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/base/for_all.h"
#include "core/base/with_threads.h"
#include "core/progressive/fill_free_group.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "ranks";
constexpr std::size_t kMaxGroupsAtOnce = 64;  // between two looks whether the work was cancelled

using Groups = std::vector<std::uint64_t>;

/// Makes a group's points. base_of(i) gives the points of lower levels of group i of the same level; filled(i) gives all points
/// of a group i that comes before this one.
template <typename BaseOf, typename Filled>
void make_group(const CurveStrata& strata, const GroupOrder& order, const StratumGroup& group, const Groups& near_groups,
                const GroupShapes& deep, std::uint64_t seed, BaseOf&& base_of, Filled&& filled, std::span<RankedPoint> points) {
  const Eigen::AlignedBox3f& box = order.shape(group, deep).box;
  const float reach = GroupOrder::influence_radius(strata.total_area(), group.level);
  std::vector<RankedPoint> done, open;
  for (const std::uint64_t i : near_groups) {
    if (i == group.index) continue;
    const bool is_filled = GroupOrder::precedes(group.level, i, group.index);
    std::vector<RankedPoint>& near = is_filled ? done : open;
    for (const RankedPoint& p : is_filled ? filled(i) : base_of(i)) {
      const Vec3f position(p.position[0], p.position[1], p.position[2]);
      if (box.squaredExteriorDistance(position) <= reach * reach) near.push_back(p);
    }
  }
  if (GroupOrder::is_free(group.level)) {
    fill_free_group(strata, group, base_of(group.index), done, open, seed, points);
  } else {
    fill_stratum_group(strata, group, base_of(group.index), done, open, seed, points);
  }
}

/// Divides groups of a level into waves: a group waits only for groups of earlier waves. near_of(i) gives the groups near group
/// i; those that are not among `groups` are waited for by nobody.
template <typename NearOf>
std::vector<Groups> waves_of(int level, Groups groups, NearOf&& near_of) {
  std::sort(groups.begin(), groups.end(), [&](std::uint64_t a, std::uint64_t b) { return GroupOrder::precedes(level, a, b); });
  std::unordered_map<std::uint64_t, std::size_t> wave_of;
  wave_of.reserve(groups.size());
  std::vector<Groups> waves;
  for (const std::uint64_t i : groups) {
    std::size_t wave = 0;
    for (const std::uint64_t other : near_of(i)) {
      if (!GroupOrder::precedes(level, other, i)) continue;
      if (const auto before = wave_of.find(other); before != wave_of.end()) wave = std::max(wave, before->second + 1);
    }
    wave_of.emplace(i, wave);
    if (wave == waves.size()) waves.emplace_back();
    waves[wave].push_back(i);
  }
  return waves;
}

/// Makes groups on demand, and first the groups that they wait for.
class GroupMaker {
 public:
  GroupMaker(const CurveStrata& strata, const GroupOrder& order, const ProgressiveOptions& options,
             std::span<const RankedPoint> points, DeepGroups& made)
      : strata_(strata), order_(order), options_(options), points_(points), made_(made) {}

  /// Makes groups of a level. Cancelled, and some of them may have been made.
  absl::Status make(int level, const Groups& wanted, const ExecutionContext& context) {
    std::vector<Groups> missing(static_cast<std::size_t>(level) + 1);
    std::unordered_set<std::uint64_t> needed(wanted.begin(), wanted.end());
    for (int l = level; l >= options_.level; --l) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      std::unordered_set<std::uint64_t> parents;
      find_missing(l, needed, missing[static_cast<std::size_t>(l)], parents, context);
      needed.swap(parents);
    }
    for (int l = options_.level; l <= level; ++l) {
      const auto near_of = [&](std::uint64_t i) -> const Groups& { return made_.near.at({l, i}); };
      for (const Groups& wave : waves_of(l, missing[static_cast<std::size_t>(l)], near_of)) {
        for (std::size_t begin = 0; begin < wave.size(); begin += kMaxGroupsAtOnce) {
          if (absl::Status status = context.check(); !status.ok()) return status;
          fill(l, std::span(wave).subspan(begin, std::min(kMaxGroupsAtOnce, wave.size() - begin)), context);
        }
      }
    }
    return absl::OkStatus();
  }

  /// Precondition: the group has been made.
  std::span<const RankedPoint> filled(int level, std::uint64_t index) const { return made_.filled.at({level, index}).points; }

 private:
  /// Adds to `missing` the groups of a level that are needed and not made, with those that they wait for; and to `parents` the
  /// groups of the level before that these need.
  void find_missing(int level, const std::unordered_set<std::uint64_t>& needed, Groups& missing,
                    std::unordered_set<std::uint64_t>& parents, const ExecutionContext& context) {
    std::unordered_set<std::uint64_t> seen = needed;
    Groups open(needed.begin(), needed.end());
    while (!open.empty()) {
      std::erase_if(open, [&](std::uint64_t index) {
        const auto found = made_.filled.find({level, index});
        if (found == made_.filled.end()) return false;
        found->second.used = made_.calls;
        return true;
      });
      find_near(level, open, context);
      Groups next;
      for (const std::uint64_t index : open) {
        missing.push_back(index);
        for (const std::uint64_t i : made_.near.at({level, index})) {
          if (level > options_.level) parents.insert(i / 4);
          if (GroupOrder::precedes(level, i, index) && seen.insert(i).second) next.push_back(i);
        }
      }
      open.swap(next);
    }
  }

  /// Finds which groups are near some of a level; and before, the same of lower levels and the shapes that this needs.
  void find_near(int level, const Groups& groups, const ExecutionContext& context) {
    Groups open;
    for (const std::uint64_t i : groups) {
      if (!made_.near.contains({level, i})) open.push_back(i);
    }
    if (open.empty()) return;
    static const Groups kWhole = {0};
    const bool is_whole = GroupOrder::count(level) == 1;
    const auto near_parent = [&](std::uint64_t i) -> const Groups& {
      return is_whole ? kWhole : made_.near.at({level - 1, i / 4});
    };
    if (!is_whole) {
      Groups parents;
      for (const std::uint64_t i : open) parents.push_back(i / 4);
      std::sort(parents.begin(), parents.end());
      parents.erase(std::unique(parents.begin(), parents.end()), parents.end());
      find_near(level - 1, parents, context);
    }
    if (!is_whole && !order_.has_shapes(level)) {
      std::vector<GroupShapes::value_type*> lacking;
      for (const std::uint64_t index : open) {
        for (const std::uint64_t parent : near_parent(index)) {
          for (std::uint64_t i = 4 * parent; i < 4 * parent + 4; ++i) {
            const auto [at, is_new] = made_.shapes.try_emplace({level, i});
            if (is_new) lacking.push_back(&*at);
          }
        }
      }
      for_all(context, lacking.size(), [&](std::size_t k) {
        lacking[k]->second = order_.find_shape({level, lacking[k]->first.index});
      });
    }
    std::vector<Groups> near(open.size());
    for_all(context, open.size(), [&](std::size_t k) {
      near[k] = order_.near({level, open[k]}, near_parent(open[k]), made_.shapes);
    });
    for (std::size_t k = 0; k < open.size(); ++k) made_.near.emplace(GroupKey{level, open[k]}, std::move(near[k]));
  }

  void fill(int level, std::span<const std::uint64_t> wave, const ExecutionContext& context) {
    const std::size_t size = StratumGroup{level, 0}.size();
    std::vector<std::vector<RankedPoint>> filled_now(wave.size());
    for_all(context, wave.size(), [&](std::size_t k) {
      filled_now[k].resize(4 * size);
      make_group(
          strata_, order_, {level, wave[k]}, made_.near.at({level, wave[k]}), made_.shapes, options_.seed,
          [&](std::uint64_t i) { return base(level, i); }, [&](std::uint64_t i) { return filled(level, i); }, filled_now[k]);
    });
    for (std::size_t k = 0; k < wave.size(); ++k) {
      made_.filled[{level, wave[k]}] = {std::move(filled_now[k]), made_.calls};
      made_.points += 4 * size;
    }
  }

  std::span<const RankedPoint> base(int level, std::uint64_t index) const {
    const std::size_t size = StratumGroup{level, index}.size();
    if (level == options_.level) return points_.subspan(index * size, size);
    return filled(level - 1, index / 4).subspan(GroupOrder::count(level) > 1 ? index % 4 * size : 0, size);
  }

  const CurveStrata& strata_;
  const GroupOrder& order_;
  const ProgressiveOptions& options_;
  std::span<const RankedPoint> points_;
  DeepGroups& made_;
};

absl::Status check_area(const SurfaceCurve& curve) {
  double area = 0;
  for (const float a : curve.area) {
    if (!(a >= 0)) return absl::InvalidArgumentError("the curve has an area element that is negative or not a number");
    area += static_cast<double>(a);
  }
  if (!(area > 0 && std::isfinite(area))) return absl::InvalidArgumentError("the curve has no area on which to place points");
  return absl::OkStatus();
}

std::unique_ptr<const GroupOrder> order_of(const CurveStrata& strata, int levels, const ExecutionContext& context) {
  return with_threads(context, [&] { return std::make_unique<const GroupOrder>(strata, levels); });
}

}  // namespace

absl::StatusOr<ProgressiveRanks> ProgressiveRanks::make(std::shared_ptr<const LeafSurface> surface,
                                                        const ProgressiveOptions& options, const ExecutionContext& context) {
  if (options.level < 0 || options.level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(
        absl::StrFormat("ranks down to level %d asked for; 0 to %d can be made at once", options.level, kMaxLevelAtOnce));
  }
  if (absl::Status status = check_area(surface->curve()); !status.ok()) return status;
  ProgressiveRanks ranks(std::move(surface), options.seed);
  ranks.points_ = {first_ranked_point(*ranks.strata_, options.seed)};
  if (absl::Status status = ranks.fill(options.level, context); !status.ok()) return status;
  return ranks;
}

absl::StatusOr<ProgressiveRanks> ProgressiveRanks::restore(std::shared_ptr<const LeafSurface> surface,
                                                           const ProgressiveOptions& options,
                                                           std::span<const RankedPosition> points,
                                                           const ExecutionContext& context) {
  if (absl::Status status = check_area(surface->curve()); !status.ok()) return status;
  ProgressiveRanks ranks(std::move(surface), options.seed);
  absl::StatusOr<std::vector<RankedPoint>> found =
      find_ranked_points(*ranks.strata_, options.level, options.seed, points, context);
  if (!found.ok()) return found.status();
  ranks.points_ = *std::move(found);
  ranks.options_.level = options.level;
  ranks.order_ = order_of(*ranks.strata_, options.level, context);
  return ranks;
}

ProgressiveRanks::ProgressiveRanks(std::shared_ptr<const LeafSurface> surface, std::uint64_t seed)
    : surface_(std::move(surface)), options_{.level = 0, .seed = seed}, strata_(std::make_unique<CurveStrata>(*surface_)) {}

void ProgressiveRanks::move_to(std::shared_ptr<const LeafSurface> surface) {
  strata_->move_to(*surface);
  surface_ = std::move(surface);
}

absl::Status ProgressiveRanks::extend(int level, const ExecutionContext& context) {
  if (level <= options_.level || level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(absl::StrFormat("ranks down to level %d asked for; there are %d, and at most %d", level,
                                                      options_.level, kMaxLevelAtOnce));
  }
  return fill(level, context);
}

absl::Status ProgressiveRanks::fill(int last, const ExecutionContext& context) {
  auto order = order_of(*strata_, last, context);
  std::vector<RankedPoint> points = points_;
  std::vector<Groups> near;
  for (int level = 0; level < last; ++level) {
    const std::size_t size = StratumGroup{level, 0}.size();
    std::vector<Groups> finer(GroupOrder::count(level));
    for_all(context, finer.size(), [&](std::size_t i) {
      finer[i] = order->near({level, i}, finer.size() > 1 ? near[i / 4] : Groups{0}, {});
    });
    near = std::move(finer);
    if (level < options_.level) continue;
    std::vector<RankedPoint> next(4 * points.size());
    const auto base_of = [&](std::uint64_t i) { return std::span<const RankedPoint>(points).subspan(i * size, size); };
    const auto filled = [&](std::uint64_t i) { return std::span(next).subspan(4 * i * size, 4 * size); };
    Groups all(near.size());
    std::iota(all.begin(), all.end(), std::uint64_t{0});
    const auto near_of = [&](std::uint64_t i) -> const Groups& { return near[i]; };
    for (const Groups& wave : waves_of(level, std::move(all), near_of)) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      for_all(context, wave.size(), [&](std::size_t k) {
        const std::uint64_t i = wave[k];
        make_group(*strata_, *order, {level, i}, near[i], {}, options_.seed, base_of, filled, filled(i));
      });
    }
    points = std::move(next);
    context.progress(kStage, std::ldexp(1.0, 2 * (level + 1 - last)));
  }
  order_ = std::move(order);
  points_ = std::move(points);
  options_.level = last;
  return absl::OkStatus();
}

absl::StatusOr<std::vector<RankedPoint>> ProgressiveRanks::deepen(int level, std::span<const StrataRange> ranges,
                                                                  DeepGroups& made, const ExecutionContext& context) const {
  if (level < options_.level || level > kMaxRankLevel) {
    return absl::InvalidArgumentError(
        absl::StrFormat("points of level %d asked for; there are those of %d to %d", level, options_.level, kMaxRankLevel));
  }
  const std::uint64_t strata = std::uint64_t{1} << 2 * level;
  std::uint64_t count = 0;
  for (const auto [first, last] : ranges) {
    if (first > last || last > strata) {
      return absl::InvalidArgumentError(
          absl::StrFormat("points of strata %d to %d of level %d asked for; there are %d", first, last, level, strata));
    }
    count += last - first;
  }
  if (count > kMaxDeepened) {
    return absl::InvalidArgumentError(absl::StrFormat("%d points asked for; at most %d are made in one go", count, kMaxDeepened));
  }
  ++made.calls;
  GroupMaker groups(*strata_, *order_, options_, points_, made);
  const std::uint64_t size = level > 0 ? 4 * StratumGroup{level - 1, 0}.size() : 1;
  if (level > options_.level) {
    std::unordered_set<std::uint64_t> wanted;
    for (const auto [first, last] : ranges) {
      for (std::uint64_t group = first / size; group * size < last; ++group) wanted.insert(group);
    }
    if (absl::Status status = groups.make(level - 1, {wanted.begin(), wanted.end()}, context); !status.ok()) return status;
  }
  std::vector<RankedPoint> points;
  points.reserve(count);
  for (const auto [first, last] : ranges) {
    if (level == options_.level) {
      const std::span<const RankedPoint> own = std::span(points_).subspan(first, last - first);
      points.insert(points.end(), own.begin(), own.end());
      continue;
    }
    for (std::uint64_t i = first; i < last;) {
      const std::uint64_t group = i / size, next = std::min(last, (group + 1) * size);
      const std::span<const RankedPoint> filled = groups.filled(level - 1, group).subspan(i - group * size, next - i);
      points.insert(points.end(), filled.begin(), filled.end());
      i = next;
    }
  }
  return points;
}

void DeepGroups::shrink(std::size_t max_points) {
  if (shapes.size() * sizeof(GroupShape) > max_points * sizeof(RankedPoint) / 2) {  // they are quickly found again
    near.clear();
    shapes.clear();
  }
  if (points <= max_points) return;
  std::vector<std::pair<std::uint64_t, std::size_t>> ages;  // when used, and how many points
  ages.reserve(filled.size());
  for (const auto& [key, group] : filled) ages.emplace_back(group.used, group.points.size());
  std::sort(ages.begin(), ages.end(), std::greater<>());
  std::size_t kept = 0;
  std::uint64_t oldest = calls;
  for (const auto& [used, size] : ages) {
    kept += size;
    if (kept > max_points) break;
    oldest = used;
  }
  std::erase_if(filled, [&](const auto& entry) { return entry.second.used < oldest; });
  points = 0;
  for (const auto& [key, group] : filled) points += group.points.size();
}

std::size_t DeepGroups::byte_size() const {
  constexpr std::size_t kNode = 64;        // of a map, about
  constexpr std::size_t kNearGroups = 12;  // about
  return points * sizeof(RankedPoint) + filled.size() * (sizeof(Filled) + kNode) +
         near.size() * (kNearGroups * sizeof(std::uint64_t) + kNode) + shapes.size() * (sizeof(GroupShape) + kNode);
}

}  // namespace curvecast
