#include "core/progressive/curve_strata.h"

#include <algorithm>
#include <cmath>

#include "core/curve/leaf_frame.h"

namespace curvecast {

CurveStrata::CurveStrata(const SurfaceCurve& curve) : curve_(&curve), before_(curve.size() + 1) {
  double sum = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    before_[l] = sum;
    sum += static_cast<double>(curve.area[l]);
  }
  before_.back() = sum;
}

std::uint32_t CurveStrata::vertex_at(double t) const {
  const auto after = std::upper_bound(before_.begin() + 1, before_.end() - 1, t * total_area());
  return static_cast<std::uint32_t>(after - before_.begin() - 1);
}

void CurveStrata::points_at(std::span<const double> t, std::span<CurvePoint> points) const {
  if (t.empty()) return;
  const std::uint32_t last = vertex_at(t.back());
  std::uint32_t l = vertex_at(t.front());
  const auto on_vertex = [&](std::size_t i) {
    while (l < last && before_[l + 1] <= t[i] * total_area()) ++l;
    return l;
  };
  LeafFrames frames(*curve_);
  for (std::size_t i = 0; i < t.size();) {
    const std::uint32_t vertex = on_vertex(i);
    std::size_t end = i + 1;
    while (end < t.size() && on_vertex(end) == vertex) ++end;
    const Vec3f middle = curve_->position(vertex);
    if (end == i + 1) {
      points[i++] = {{middle.x(), middle.y(), middle.z()}, vertex};
      continue;
    }
    const LeafFrame frame = frames.of(vertex);
    for (; i < end; ++i) {
      const double part = (t[i] * total_area() - before_[vertex]) / static_cast<double>(curve_->area[vertex]);
      const Vec3f p = middle + frame.offset(part);
      points[i] = {{p.x(), p.y(), p.z()}, vertex};
    }
  }
}

Eigen::AlignedBox3f CurveStrata::box(int level, std::uint64_t stratum) const {
  const std::uint32_t first = vertex_at(std::ldexp(static_cast<double>(stratum), -2 * level));
  const std::uint32_t last = vertex_at(std::ldexp(static_cast<double>(stratum + 1), -2 * level));
  Eigen::AlignedBox3f box;
  for (std::uint32_t l = first; l <= last; ++l) {
    const Vec3f half_leaf = Vec3f::Constant(0.5f * std::sqrt(curve_->area[l]));
    box.extend(curve_->position(l) - half_leaf);
    box.extend(curve_->position(l) + half_leaf);
  }
  return box;
}

}  // namespace curvecast
