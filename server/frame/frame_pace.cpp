#include "server/frame/frame_pace.h"

#include <algorithm>
#include <cmath>

namespace curvecast::server {
namespace {

constexpr double kLeastPoints = 500;
// Every change of the number costs points: within these it stays. It falls fast, so that the camera moves again, and grows
// slowly.
constexpr double kTooLong = 1.25, kTooShort = 0.6;
constexpr double kMostFall = 0.4, kGrowth = 1.25;

}  // namespace

std::uint64_t FramePace::points(const AutomaticBudget& budget) const { return std::min(points_, budget.max_points); }

void FramePace::observe(const AutomaticBudget& budget, std::uint64_t points, Seconds took) {
  if (points != this->points(budget)) return;  // a frame from before the last change
  const double share = took.count() / budget.frame_seconds;
  double factor = 1;
  if (share > kTooLong) factor = std::max(1 / share, kMostFall);
  if (share < kTooShort) factor = kGrowth;
  const double next = std::clamp(std::round(static_cast<double>(points) * factor), kLeastPoints,
                                 std::max(static_cast<double>(budget.max_points), kLeastPoints));
  points_ = static_cast<std::uint64_t>(next);
}

}  // namespace curvecast::server
