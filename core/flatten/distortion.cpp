#include "core/flatten/distortion.h"

#include <algorithm>

#include "core/flatten/orientation.h"

namespace curvecast {

std::uint64_t count_flipped(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  std::uint64_t flipped = 0;
  for (const Triangle& t : disc.triangles) flipped += orientation(uv[t[0]], uv[t[1]], uv[t[2]]) <= 0;
  return flipped;
}

std::vector<double> area_ratios(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  std::vector<double> ratios;
  ratios.reserve(disc.triangles.size());
  for (const Triangle& t : disc.triangles) {
    const Vec3d &a = disc.positions[t[0]], &b = disc.positions[t[1]], &c = disc.positions[t[2]];
    const Vec2d p = uv[t[1]] - uv[t[0]];
    const Vec2d q = uv[t[2]] - uv[t[0]];
    ratios.push_back((b - a).cross(c - a).norm() / (p.x() * q.y() - p.y() * q.x()));
  }
  return ratios;
}

Distortion summarise_distortion(std::vector<AreaShare> shares) {
  for (AreaShare& share : shares) share.ratio = std::max(share.ratio, 1 / share.ratio);
  std::sort(shares.begin(), shares.end(), [](const AreaShare& a, const AreaShare& b) { return a.ratio < b.ratio; });
  double total = 0;
  for (const AreaShare& share : shares) total += share.area;
  Distortion distortion;
  double sum = 0;
  for (const AreaShare& share : shares) {
    if (sum <= 0.50 * total) distortion.p50 = share.ratio;
    if (sum <= 0.99 * total) distortion.p99 = share.ratio;
    distortion.max = share.ratio;
    sum += share.area;
  }
  return distortion;
}

}  // namespace curvecast
