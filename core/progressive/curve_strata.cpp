#include "core/progressive/curve_strata.h"

#include <algorithm>
#include <cmath>

#include "core/curve/leaf_frame.h"

namespace curvecast {
namespace {

constexpr std::uint32_t kFewLeaves = 3;
// Places in a leaf of at most this part of the grain are taken to be its vertex.
constexpr double kSmallLeaf = 0.05;

}  // namespace

CurveStrata::CurveStrata(const LeafSurface& surface) : surface_(&surface), before_(surface.curve().size() + 1) {
  double sum = 0;
  for (std::size_t l = 0; l < curve().size(); ++l) {
    before_[l] = sum;
    sum += static_cast<double>(curve().area[l]);
  }
  before_.back() = sum;
}

std::uint32_t CurveStrata::vertex_at(double t) const {
  const auto after = std::upper_bound(before_.begin() + 1, before_.end() - 1, t * total_area());
  return static_cast<std::uint32_t>(after - before_.begin() - 1);
}

CurvePoint CurveStrata::at_vertex(std::uint32_t l) const {
  const SurfaceCurve& c = curve();
  return {{{c.x[l], c.y[l], c.z[l]}, {c.nx[l], c.ny[l], c.nz[l]}, c.triangle[l], c.weight_1[l], c.weight_2[l]}, l};
}

CurvePoint CurveStrata::about_vertex(std::uint32_t l, const Vec3f& offset) const {
  CurvePoint point = at_vertex(l);
  for (int k = 0; k < 3; ++k) point.position[k] += offset[k];
  point.face = kNone;
  return point;
}

void CurveStrata::points_at(std::span<const double> t, double grain, std::span<CurvePoint> points, PointPlaces how) const {
  if (t.empty()) return;
  const std::uint32_t last = vertex_at(t.back());
  std::uint32_t l = vertex_at(t.front());
  const auto on_vertex = [&](std::size_t i) {
    while (l < last && before_[l + 1] <= t[i] * total_area()) ++l;
    return l;
  };
  std::vector<LeafPart> even;        // in leaves no larger than the grain
  std::vector<std::size_t> even_at;  // which of the points these are
  std::vector<double> parts;
  std::vector<SurfacePlace> places;
  LeafFrames frames(curve());
  LeafFrame frame;
  std::uint32_t framed = kNone;  // the leaf of the frame
  const double all = total_area();
  for (std::size_t i = 0; i < t.size();) {
    const std::uint32_t vertex = on_vertex(i);
    const double area = static_cast<double>(curve().area[vertex]);
    if (how == PointPlaces::kAtVertices && area <= kSmallLeaf * grain * all) {
      points[i++] = at_vertex(vertex);
      continue;
    }
    const auto part_at = [&](std::size_t k) { return (t[k] * all - before_[vertex]) / area; };
    if (area <= grain * all) {
      if (how == PointPlaces::kAbout) {
        if (vertex != framed) {
          frame = frames.of(vertex);
          framed = vertex;
        }
        if (frame.is_known()) {
          points[i] = about_vertex(vertex, frame.offset(part_at(i)));
          ++i;
          continue;
        }
      }
      even_at.push_back(i);
      even.push_back({vertex, part_at(i++)});
      continue;
    }
    std::size_t end = i + 1;
    while (end < t.size() && on_vertex(end) == vertex) ++end;
    parts.clear();
    for (std::size_t k = i; k < end; ++k) parts.push_back(std::clamp(part_at(k), 0.0, 1.0));
    places.resize(parts.size());
    surface_->find(vertex, parts, grain * all / area, places);
    for (std::size_t k = 0; i < end; ++i, ++k) points[i] = {places[k], vertex};
  }
  places.resize(even.size());
  surface_->find_even(even, places);
  for (std::size_t k = 0; k < even.size(); ++k) points[even_at[k]] = {places[k], even[k].leaf};
}

std::vector<CurvePoint> CurveStrata::spread_over(int level, std::uint64_t stratum, std::size_t count, PointPlaces places) const {
  const double step = 1 / static_cast<double>(count);
  std::vector<double> t(count);
  for (std::size_t i = 0; i < count; ++i) {
    t[i] = std::ldexp(static_cast<double>(stratum) + (static_cast<double>(i) + 0.5) * step, -2 * level);
  }
  std::vector<CurvePoint> points(count);
  points_at(t, std::ldexp(places == PointPlaces::kAbout ? 4 * step : step, -2 * level), points, places);
  return points;
}

bool CurveStrata::is_within_leaves(int level, std::uint64_t stratum) const {
  const std::uint32_t first = vertex_at(std::ldexp(static_cast<double>(stratum), -2 * level));
  return vertex_at(std::ldexp(static_cast<double>(stratum + 1), -2 * level)) - first < kFewLeaves;
}

}  // namespace curvecast
