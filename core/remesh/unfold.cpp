#include "core/remesh/unfold.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curvecast {
namespace {

/// The tangent of a triangle's smallest angle. The cotangent of each is the product of its sides over twice the area.
double least_tangent(const Triangle& t, std::span<const Vec3d> at, double twice_area) {
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d& corner = at[t[i]];
    most = std::max(most, (at[t[(i + 1) % 3]] - corner).dot(at[t[(i + 2) % 3]] - corner));
  }
  return twice_area / most;
}

bool is_sound(const Triangle& t, std::span<const Vec3d> before, std::span<const Vec3d> after, double tangent) {
  const Vec3d was = area_vector(t, before), is = area_vector(t, after);
  const double area_before = was.norm(), area_after = is.norm();
  if (!(was.dot(is) > 0.25 * area_before * std::min(area_before, area_after))) return false;
  if (tangent == 0) return true;
  const double least = least_tangent(t, after, area_after);
  return least >= tangent || least >= least_tangent(t, before, area_before);
}

}  // namespace

std::vector<bool> unfold(std::span<const Triangle> triangles, std::span<const Vec3d> before, std::span<Vec3d> after,
                         const UnfoldOptions& options) {
  const double tangent = std::tan(options.least_angle * std::numbers::pi / 180);
  std::vector<std::uint8_t> cuts(before.size(), 0);
  const auto is_back = [&](std::uint32_t v) { return cuts[v] > options.halvings; };
  for (bool is_done = false; !is_done;) {
    is_done = true;
    for (const Triangle& t : triangles) {
      if (t[0] == kNone || is_sound(t, before, after, tangent)) continue;
      for (const std::uint32_t v : t) {
        if (is_back(v)) continue;
        ++cuts[v];
        after[v] = is_back(v) ? before[v] : Vec3d(0.5 * (before[v] + after[v]));
        is_done = false;
      }
    }
  }
  std::vector<bool> back(before.size());
  for (std::uint32_t v = 0; v < back.size(); ++v) back[v] = is_back(v);
  return back;
}

}  // namespace curvecast
