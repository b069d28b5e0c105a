#include "core/progressive/find_ranked_points.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <bit>

#include "core/base/for_all.h"
#include "core/base/random.h"
#include "core/progressive/candidate_points.h"
#include "core/progressive/group_order.h"

namespace curvecast {
namespace {

constexpr std::size_t kPlacedAtOnce = 1024;  // by one thread

/// Whether there is one in each stratum, in curve order, and each rank once.
bool are_whole(std::span<const RankedPosition> positions, int level) {
  if (positions.size() != std::size_t{1} << 2 * level) return false;
  std::vector<bool> has_rank(positions.size(), false);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto [position, rank] = positions[i];
    const std::uint64_t stratum = level > 0 ? position >> (64 - 2 * level) : 0;
    if (stratum != i || rank >= positions.size() || has_rank[rank]) return false;
    has_rank[rank] = true;
  }
  return true;
}

/// The level of the groups that have such ranks. Precondition: rank > 0.
std::size_t group_level(std::uint64_t rank) { return static_cast<std::size_t>(std::bit_width(rank) - 1) / 2; }

/// Finds points of groups of one level, whose numbers in `positions` and `points` are given.
void find_points(const CurveStrata& strata, int level, std::span<const std::size_t> numbers,
                 std::span<const RankedPosition> positions, std::span<RankedPoint> points) {
  std::vector<double> t;
  for (const std::size_t i : numbers) t.push_back(unit_curve_position(positions[i].curve_position));
  std::vector<CurvePoint> at(t.size());
  strata.points_at(t, grain_of_candidates(level), at);
  for (std::size_t k = 0; k < at.size(); ++k) {
    points[numbers[k]] = {at[k], positions[numbers[k]].curve_position, positions[numbers[k]].rank};
  }
}

}  // namespace

RankedPoint first_ranked_point(const CurveStrata& strata, std::uint64_t seed) {
  const std::uint64_t curve_position = mix_bits(seed);
  const double t = unit_curve_position(curve_position);
  CurvePoint at{};
  strata.points_at({&t, 1}, 1, {&at, 1});
  return {at, curve_position, 0};
}

absl::StatusOr<std::vector<RankedPoint>> find_ranked_points(const CurveStrata& strata, int level, std::uint64_t seed,
                                                            std::span<const RankedPosition> positions,
                                                            const ExecutionContext& context) {
  if (level < 0 || level > kFirstFreeLevel) {
    return absl::InvalidArgumentError(
        absl::StrFormat("ranks down to level %d to be found again; 0 to %d can be", level, kFirstFreeLevel));
  }
  if (!are_whole(positions, level)) {
    return absl::InvalidArgumentError(absl::StrFormat("there is not one point in each stratum of level %d", level));
  }
  std::vector<RankedPoint> points(positions.size());
  std::vector<std::vector<std::size_t>> of_level(static_cast<std::size_t>(level));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i].rank == 0) {
      points[i] = first_ranked_point(strata, seed);
    } else {
      of_level[group_level(positions[i].rank)].push_back(i);
    }
  }
  for (std::size_t l = 0; l < of_level.size(); ++l) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    const std::span<const std::size_t> numbers = of_level[l];
    for_all(context, (numbers.size() + kPlacedAtOnce - 1) / kPlacedAtOnce, [&](std::size_t part) {
      const std::size_t begin = part * kPlacedAtOnce;
      find_points(strata, static_cast<int>(l), numbers.subspan(begin, std::min(kPlacedAtOnce, numbers.size() - begin)), positions,
                  points);
    });
  }
  return points;
}

}  // namespace curvecast
