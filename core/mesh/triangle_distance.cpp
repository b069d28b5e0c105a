#include "core/mesh/triangle_distance.h"

#include <algorithm>

namespace curvecast {
namespace {

Vec3d nearest_on_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double square = d.squaredNorm();
  const double t = square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0;
  return a + t * d;
}

double segment_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b) { return (p - nearest_on_segment(p, a, b)).norm(); }

/// `normal`: of the triangle, with a length.
bool is_above(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& normal) {
  return (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 && (a - c).cross(p - c).dot(normal) >= 0;
}

}  // namespace

double triangle_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double sides = std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
  const Vec3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (!(length > 0)) return sides;
  return is_above(p, a, b, c, normal) ? std::min(std::abs((p - a).dot(normal)) / length, sides) : sides;
}

Vec3d nearest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Vec3d best = nearest_on_segment(p, a, b);
  const auto take = [&](const Vec3d& other) {
    if ((p - other).squaredNorm() < (p - best).squaredNorm()) best = other;
  };
  take(nearest_on_segment(p, b, c));
  take(nearest_on_segment(p, c, a));
  const Vec3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  if (square > 0 && is_above(p, a, b, c, normal)) take(p - ((p - a).dot(normal) / square) * normal);
  return best;
}

}  // namespace curvecast
