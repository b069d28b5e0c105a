// Which of the progressive sampler's candidates a density shows.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/sample/rank_block.h"

namespace curvecast {

/// What a point needs to be shown: it is where the scale is at least (rank + 1) / density. Infinite without density. A greater
/// density never needs more.
inline double needed_scale(const RankedPoint& point, float density) {
  return density > 0 ? (static_cast<double>(point.rank) + 1) / static_cast<double>(density)
                     : std::numeric_limits<double>::infinity();
}

struct RankSelection {
  std::vector<std::uint32_t> points;  // indices, ascending
  double scale = 0;                   // with which just these are shown (more only where two need the same)
  /// The ranks below which candidates are needed where the density is greatest: with as many there or more the selection is what
  /// it would be with candidates of all ranks.
  double ranks = 0;
};

/// Writes the indices of the points that are shown at a scale, ascending, to `shown`: for densities of which one is nowhere
/// greater than the other, or for two scales, the one set is part of the other. Precondition: a density for each point.
void shown_points(std::span<const RankedPoint> points, std::span<const float> density, double scale,
                  std::vector<std::uint32_t>& shown);

/// The n points that need the least scale; of those that need the same, those of the lower ranks. Precondition: a density for
/// each point. InvalidArgument: n = 0; a density that is negative or not finite. OutOfRange: fewer than n points have a density.
absl::StatusOr<RankSelection> select_ranked(std::span<const RankedPoint> points, std::span<const float> density, std::uint64_t n);

}  // namespace curvecast
