#include "core/progressive/progressive.h"

#include <absl/strings/str_format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/random.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "ranks";

using Groups = std::vector<std::uint64_t>;

RankedPoint first_point(const CurveStrata& strata, std::uint64_t seed) {
  const std::uint64_t curve_position = mix_bits(seed);
  const SurfaceCurve& curve = strata.curve();
  const std::uint32_t l = strata.vertex_at(unit_curve_position(curve_position));
  return {curve_position, {curve.x[l], curve.y[l], curve.z[l]}, {curve.nx[l], curve.ny[l], curve.nz[l]}, l, 0};
}

/// Makes a group's points. base_of(i) gives the points of lower levels of group i of the same level; filled(i) gives all points
/// of a group i that comes before this one.
template <typename BaseOf, typename Filled>
void make_group(const CurveStrata& strata, const GroupOrder& order, const StratumGroup& group, const Groups& near_groups,
                std::uint64_t seed, BaseOf&& base_of, Filled&& filled, std::span<RankedPoint> points) {
  const Eigen::AlignedBox3f box = order.box(group);
  const float reach = influence_radius(strata.total_area(), group.level);
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
  fill_stratum_group(strata, group, base_of(group.index), done, open, seed, points);
}

/// Divides the groups of a level into waves: a group waits only for groups of earlier waves.
std::vector<Groups> waves_of(int level, std::span<const Groups> near) {
  Groups sorted(near.size());
  for (std::size_t i = 0; i < near.size(); ++i) sorted[i] = i;
  std::sort(sorted.begin(), sorted.end(), [&](std::uint64_t a, std::uint64_t b) { return GroupOrder::precedes(level, a, b); });
  std::vector<std::size_t> wave(near.size(), 0);
  std::vector<Groups> waves;
  for (const std::uint64_t i : sorted) {
    for (const std::uint64_t other : near[i]) {
      if (GroupOrder::precedes(level, other, i)) wave[i] = std::max(wave[i], wave[other] + 1);
    }
    if (wave[i] == waves.size()) waves.emplace_back();
    waves[wave[i]].push_back(i);
  }
  return waves;
}

/// Makes groups on demand, and first the groups that they wait for.
class GroupMaker {
 public:
  GroupMaker(const CurveStrata& strata, const GroupOrder& order, const ProgressiveOptions& options,
             std::span<const RankedPoint> points, DeepGroups& made)
      : strata_(strata), order_(order), options_(options), points_(points), made_(made) {}

  std::span<const RankedPoint> filled(int level, std::uint64_t index) {
    if (const auto found = made_.filled.find({level, index}); found != made_.filled.end()) return found->second;
    const StratumGroup group{level, index};
    std::vector<RankedPoint> points(4 * group.size());
    make_group(
        strata_, order_, group, near(level, index), options_.seed, [&](std::uint64_t i) { return base(level, i); },
        [&](std::uint64_t i) { return filled(level, i); }, points);
    made_.points += points.size();
    return made_.filled.emplace(DeepGroups::Key(level, index), std::move(points)).first->second;
  }

 private:
  std::span<const RankedPoint> base(int level, std::uint64_t index) {
    const std::size_t size = StratumGroup{level, index}.size();
    if (level == options_.level) return points_.subspan(index * size, size);
    return filled(level - 1, index / 4).subspan(GroupOrder::count(level) > 1 ? index % 4 * size : 0, size);
  }

  const Groups& near(int level, std::uint64_t index) {
    if (const auto found = made_.near.find({level, index}); found != made_.near.end()) return found->second;
    const bool is_whole = GroupOrder::count(level) == 1;
    Groups groups = order_.near({level, index}, is_whole ? Groups{0} : near(level - 1, index / 4));
    return made_.near.emplace(DeepGroups::Key(level, index), std::move(groups)).first->second;
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

}  // namespace

absl::StatusOr<ProgressiveRanks> ProgressiveRanks::make(std::shared_ptr<const SurfaceCurve> curve,
                                                        const ProgressiveOptions& options, const ExecutionContext& context) {
  if (options.level < 0 || options.level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(
        absl::StrFormat("ranks down to level %d asked for; 0 to %d can be made at once", options.level, kMaxLevelAtOnce));
  }
  if (absl::Status status = check_area(*curve); !status.ok()) return status;
  ProgressiveRanks ranks;
  ranks.curve_ = std::move(curve);
  ranks.options_ = {.level = 0, .seed = options.seed};
  ranks.strata_ = std::make_unique<CurveStrata>(*ranks.curve_);
  ranks.points_ = {first_point(*ranks.strata_, options.seed)};
  if (absl::Status status = ranks.fill(options.level, context); !status.ok()) return status;
  return ranks;
}

absl::Status ProgressiveRanks::extend(int level, const ExecutionContext& context) {
  if (level <= options_.level || level > kMaxLevelAtOnce) {
    return absl::InvalidArgumentError(absl::StrFormat("ranks down to level %d asked for; there are %d, and at most %d", level,
                                                      options_.level, kMaxLevelAtOnce));
  }
  return fill(level, context);
}

absl::Status ProgressiveRanks::fill(int last, const ExecutionContext& context) {
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  auto order = arena.execute([&] { return std::make_unique<GroupOrder>(*strata_, last); });
  std::vector<RankedPoint> points = points_;
  std::vector<Groups> near;
  for (int level = 0; level < last; ++level) {
    const std::size_t size = StratumGroup{level, 0}.size();
    std::vector<Groups> finer(GroupOrder::count(level));
    arena.execute([&] {
      tbb::parallel_for(std::size_t{0}, finer.size(), [&](std::size_t i) {
        finer[i] = order->near({level, i}, finer.size() > 1 ? near[i / 4] : Groups{0});
      });
    });
    near = std::move(finer);
    if (level < options_.level) continue;
    std::vector<RankedPoint> next(4 * points.size());
    const auto base_of = [&](std::uint64_t i) { return std::span<const RankedPoint>(points).subspan(i * size, size); };
    const auto filled = [&](std::uint64_t i) { return std::span(next).subspan(4 * i * size, 4 * size); };
    for (const Groups& wave : waves_of(level, near)) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      arena.execute([&] {
        tbb::parallel_for(std::size_t{0}, wave.size(), [&](std::size_t k) {
          const std::uint64_t i = wave[k];
          make_group(*strata_, *order, {level, i}, near[i], options_.seed, base_of, filled, filled(i));
        });
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
  std::vector<RankedPoint> points;
  points.reserve(count);
  GroupMaker groups(*strata_, *order_, options_, points_, made);
  for (const auto [first, last] : ranges) {
    if (level == options_.level) {
      const std::span<const RankedPoint> own = std::span(points_).subspan(first, last - first);
      points.insert(points.end(), own.begin(), own.end());
      continue;
    }
    const std::uint64_t size = 4 * StratumGroup{level - 1, 0}.size();
    for (std::uint64_t i = first; i < last;) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      const std::uint64_t group = i / size, next = std::min(last, (group + 1) * size);
      const std::span<const RankedPoint> filled = groups.filled(level - 1, group).subspan(i - group * size, next - i);
      points.insert(points.end(), filled.begin(), filled.end());
      i = next;
    }
  }
  return points;
}

}  // namespace curvecast
