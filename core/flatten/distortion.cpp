#include "core/flatten/distortion.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/flatten/flatten.h"
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

Stretch measure_stretch(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  constexpr double kSmallestArea = 1e-60;  // in uv: stands for triangles that rounding has collapsed or folded
  Stretch stretch;
  stretch.vertex.assign(disc.vertex_count(), 0.0);
  std::vector<double> area_sum(disc.vertex_count(), 0.0);
  double surface = 0;
  for (const Triangle& t : disc.triangles) {
    const Vec2d p = uv[t[1]] - uv[t[0]];
    const Vec2d q = uv[t[2]] - uv[t[0]];
    const Vec3d e = disc.positions[t[1]] - disc.positions[t[0]];
    const Vec3d f = disc.positions[t[2]] - disc.positions[t[0]];
    const double area = 0.5 * e.cross(f).norm();
    const double determinant = std::max(p.x() * q.y() - p.y() * q.x(), kSmallestArea);
    const Vec3d along_u = (e * q.y() - f * p.y()) / determinant;
    const Vec3d along_v = (f * p.x() - e * q.x()) / determinant;
    const double square = 0.5 * (along_u.squaredNorm() + along_v.squaredNorm());
    for (const std::uint32_t v : t) {
      stretch.vertex[v] += area * square;
      area_sum[v] += area;
    }
    stretch.total += area * square;
    surface += area;
  }
  stretch.total = std::sqrt(stretch.total) / surface;  // the square's own area is 1
  for (std::size_t v = 0; v < area_sum.size(); ++v) stretch.vertex[v] = std::sqrt(stretch.vertex[v] / (area_sum[v] * surface));
  return stretch;
}

Distortion summarise_distortion(std::vector<AreaShare> shares) {
  Distortion distortion;
  double total = 0;
  for (AreaShare& share : shares) {
    const double levels = std::max(0.0, 0.5 * std::log2(share.ratio));
    distortion.extra_levels_mean += share.area * levels;
    distortion.extra_levels_max = std::max(distortion.extra_levels_max, levels);
    total += share.area;
  }
  distortion.extra_levels_mean /= total;
  const auto quantile = [&](double part) {
    double sum = 0;
    for (const AreaShare& share : shares) {
      sum += share.area;
      if (sum > part * total) return share.ratio;
    }
    return shares.back().ratio;
  };
  const auto sort = [&] {
    tbb::parallel_sort(shares.begin(), shares.end(), [](const AreaShare& a, const AreaShare& b) {
      return a.ratio < b.ratio || (a.ratio == b.ratio && a.area < b.area);
    });
  };
  sort();
  distortion.density_p999 = quantile(0.999);
  for (AreaShare& share : shares) share.ratio = std::max(share.ratio, 1 / share.ratio);
  sort();
  distortion.p50 = quantile(0.5);
  distortion.p99 = quantile(0.99);
  distortion.p999 = quantile(0.999);
  distortion.max = shares.back().ratio;
  return distortion;
}

Distortion measure_distortion(std::span<const Chart> charts) {
  std::vector<std::size_t> first = {0};
  for (const Chart& chart : charts) first.push_back(first.back() + chart.area_ratio.size());
  std::vector<AreaShare> shares(first.back());
  tbb::parallel_for(std::size_t{0}, charts.size(), [&](std::size_t c) {
    const Chart& chart = charts[c];
    const double mean = surface_area(chart.disc);  // the square's area is 1
    for (std::size_t t = 0; t < chart.area_ratio.size(); ++t) {
      shares[first[c] + t] = {uv_area(chart.disc, chart.uv, t) * chart.area_ratio[t], chart.area_ratio[t] / mean};
    }
  });
  return summarise_distortion(std::move(shares));
}

}  // namespace curvecast
