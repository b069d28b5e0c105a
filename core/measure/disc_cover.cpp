#include "core/measure/disc_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/cross.h"
#include "core/measure/neighbours.h"

namespace curvecast {
namespace {

using Polygon = std::vector<Vec2d>;  // convex, counter-clockwise

/// Leaves of the polygon what is no farther than `offset` in the direction `normal`.
void cut(Polygon& polygon, const Vec2d& normal, double offset) {
  Polygon rest;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double over_a = normal.dot(a) - offset, over_b = normal.dot(b) - offset;
    if (over_a <= 0) rest.push_back(a);
    if ((over_a <= 0) != (over_b <= 0)) rest.emplace_back(a + over_a / (over_a - over_b) * (b - a));
  }
  polygon = std::move(rest);
}

/// Signed area of what a disc about the origin has of the triangle from there to a and b.
double wedge(const Vec2d& a, const Vec2d& b, double radius) {
  // The side from a to b, divided where it meets the circle: within it triangles, outside sectors.
  const Vec2d along = b - a;
  const double square = along.squaredNorm();
  if (!(square > 0)) return 0;
  const double middle = -a.dot(along) / square;  // of the chord
  const double half = std::sqrt(std::max(0.0, middle * middle - (a.squaredNorm() - radius * radius) / square));
  const std::array<double, 4> t = {0, std::clamp(middle - half, 0.0, 1.0), std::clamp(middle + half, 0.0, 1.0), 1};
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2d from = a + t[i] * along, to = a + t[i + 1] * along;
    if (i == 1) {
      area += 0.5 * cross(from, to);
    } else {
      area += 0.5 * radius * radius * std::atan2(cross(from, to), from.dot(to));
    }
  }
  return area;
}

}  // namespace

double disc_cover(std::span<const Vec2d> points, double radius) {
  std::vector<Vec3f> places;
  for (const Vec2d& p : points) places.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0f);
  const NeighbourTree tree(std::move(places));
  const auto reach = static_cast<float>(2 * radius + 1e-6);  // farther by what the tree rounds
  std::vector<Neighbour> near;
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec2d& centre = points[i];
    Polygon cell = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (Vec2d& corner : cell) corner -= centre;
    tree.within(tree.points()[i], reach * reach, near);
    for (const Neighbour& other : near) {
      const Vec2d across = points[other.index] - centre;
      if (across.isZero(0)) {
        if (other.index < i) cell.clear();  // of several at one place the first has the cell
        continue;
      }
      cut(cell, across, 0.5 * across.squaredNorm());
    }
    for (std::size_t k = 0; k < cell.size(); ++k) area += wedge(cell[k], cell[(k + 1) % cell.size()], radius);
  }
  return area;
}

}  // namespace curvecast
