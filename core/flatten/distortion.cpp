#include "core/flatten/distortion.h"

#include <algorithm>

#include "core/flatten/orientation.h"

namespace curvecast {

std::uint64_t count_flipped(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  std::uint64_t flipped = 0;
  for (const Triangle& t : disc.triangles) flipped += orientation(uv[t[0]], uv[t[1]], uv[t[2]]) <= 0;
  return flipped;
}

double uv_area(const DiscMesh& disc, const std::vector<Vec2d>& uv, std::size_t t) {
  const Triangle& v = disc.triangles[t];
  const Vec2d p = uv[v[1]] - uv[v[0]];
  const Vec2d q = uv[v[2]] - uv[v[0]];
  return 0.5 * (p.x() * q.y() - p.y() * q.x());
}

std::vector<double> area_ratios(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  std::vector<double> ratios(disc.triangles.size());
  for (std::size_t t = 0; t < ratios.size(); ++t) {
    const Triangle& v = disc.triangles[t];
    const Vec3d &a = disc.positions[v[0]], &b = disc.positions[v[1]], &c = disc.positions[v[2]];
    ratios[t] = 0.5 * (b - a).cross(c - a).norm() / uv_area(disc, uv, t);
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
    if (sum <= 0.999 * total) distortion.p999 = share.ratio;
    distortion.max = share.ratio;
    sum += share.area;
  }
  return distortion;
}

}  // namespace curvecast
