#include "core/measure/star_discrepancy.h"

#include <algorithm>
#include <vector>

namespace curvecast {

double star_discrepancy(std::span<const Vec2d> points) {
  std::vector<Vec2d> sorted(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(), [](const Vec2d& a, const Vec2d& b) { return a.x() < b.x(); });
  const auto n = static_cast<double>(points.size());
  // Extremal boxes end at points or at the square's sides. Between one x and the next the points before are the same; among these
  // a box that just takes in a y has the most, and one that just leaves the next one out the fewest.
  std::vector<double> heights = {0, 1};  // of the points before, between the square's sides
  heights.reserve(points.size() + 2);
  double most = 0;
  for (std::size_t l = 0; l <= sorted.size(); ++l) {
    const double x = l > 0 ? sorted[l - 1].x() : 0, next_x = l < sorted.size() ? sorted[l].x() : 1;
    if (l > 0) heights.insert(std::upper_bound(heights.begin(), heights.end() - 1, sorted[l - 1].y()), sorted[l - 1].y());
    for (std::size_t k = 0; k <= l; ++k) {
      const double share = static_cast<double>(k) / n;
      most = std::max({most, share - x * heights[k], next_x * heights[k + 1] - share});
    }
  }
  return most;
}

}  // namespace curvecast
