#include "core/mesh/triangle_distance.h"

#include <algorithm>

namespace curvecast {
namespace {

double segment_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double square = d.squaredNorm();
  const double t = square > 0 ? std::clamp((p - a).dot(d) / square, 0.0, 1.0) : 0;
  return (p - (a + t * d)).norm();
}

}  // namespace

double triangle_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double sides = std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
  const Vec3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (!(length > 0)) return sides;
  const bool inside =
      (b - a).cross(p - a).dot(normal) >= 0 && (c - b).cross(p - b).dot(normal) >= 0 && (a - c).cross(p - c).dot(normal) >= 0;
  return inside ? std::min(std::abs((p - a).dot(normal)) / length, sides) : sides;
}

}  // namespace curvecast
