#include "core/sample/spread_in_leaves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

namespace curvecast {

void spread_in_leaves(const LeafSurface& surface, PointSet& points) {
  const SurfaceCurve& curve = surface.curve();
  std::vector<double> parts;
  std::vector<SurfacePlace> places;
  for (std::size_t begin = 0, end; begin < points.size(); begin = end) {
    const std::uint32_t l = points.vertices[begin];
    for (end = begin + 1; end < points.size() && points.vertices[end] == l;) ++end;
    const std::size_t count = end - begin;
    if (count == 1) continue;
    // In the middle of quads of their own: the curve comes back to where it was, almost, at the borders of its quads.
    const double step = 1 / static_cast<double>(count);
    const double quads = std::ldexp(1.0, 2 * ((static_cast<int>(std::bit_width(count - 1)) + 1) / 2));
    parts.clear();
    for (std::size_t i = 0; i < count; ++i) {
      parts.push_back((std::floor((static_cast<double>(i) + 0.5) * step * quads) + 0.5) / quads);
    }
    places.resize(count);
    surface.find(l, parts, 1 / quads, places);
    for (std::size_t i = 0; i < count; ++i) {
      const SurfacePlace& at = places[i];
      points.positions[begin + i] = {at.position[0], at.position[1], at.position[2]};
      points.normals[begin + i] = {at.normal[0], at.normal[1], at.normal[2]};
      if (!points.places.empty()) points.places[begin + i] = {at.face, at.weight_1, at.weight_2};
      if (!points.colours.empty()) {
        const double share = step * static_cast<double>(curve.area[l]) / curve.total_area;
        points.colours[begin + i] = surface.colour(l, at.face, {at.weight_1, at.weight_2}, share);
      }
    }
  }
}

bool shares_vertices(const PointSet& points) {
  return std::adjacent_find(points.vertices.begin(), points.vertices.end()) != points.vertices.end();
}

void find_places(const SurfaceCurve& curve, PointSet& points) {
  points.places.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t l = points.vertices[i];
    points.places[i] = {curve.triangle[l], curve.weight_1[l], curve.weight_2[l]};
  }
}

}  // namespace curvecast
