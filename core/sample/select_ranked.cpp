#include "core/sample/select_ranked.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

namespace curvecast {

void shown_points(std::span<const RankedPoint> points, std::span<const float> density, double scale,
                  std::vector<std::uint32_t>& shown) {
  shown.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (needed_scale(points[i], density[i]) <= scale) shown.push_back(static_cast<std::uint32_t>(i));
  }
}

absl::StatusOr<RankSelection> select_ranked(std::span<const RankedPoint> points, std::span<const float> density,
                                            std::uint64_t n) {
  if (n == 0) return absl::InvalidArgumentError("the number of points is 0; ask for at least 1");
  struct Candidate {
    double scale;
    std::uint32_t rank, index;
    bool operator<(const Candidate& other) const { return scale < other.scale || (scale == other.scale && rank < other.rank); }
  };
  std::vector<Candidate> candidates;
  candidates.reserve(points.size());
  float greatest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(density[i] >= 0 && std::isfinite(density[i]))) {
      return absl::InvalidArgumentError(
          absl::StrFormat("the density of candidate %d is %g; it has to be finite and not negative", i, density[i]));
    }
    if (density[i] == 0) continue;
    candidates.push_back({needed_scale(points[i], density[i]), points[i].rank, static_cast<std::uint32_t>(i)});
    greatest = std::max(greatest, density[i]);
  }
  if (candidates.size() < n) {
    return absl::OutOfRangeError(
        absl::StrFormat("%d points asked for; only %d of the candidates have a density", n, candidates.size()));
  }
  const auto last = candidates.begin() + static_cast<std::ptrdiff_t>(n - 1);
  std::nth_element(candidates.begin(), last, candidates.end());
  RankSelection selection{.scale = last->scale, .ranks = last->scale * static_cast<double>(greatest)};
  selection.points.reserve(n);
  for (auto at = candidates.begin(); at <= last; ++at) selection.points.push_back(at->index);
  std::sort(selection.points.begin(), selection.points.end());
  return selection;
}

}  // namespace curvecast
