#include "core/measure/area_in_ball.h"

#include <algorithm>
#include <cmath>

#include "core/base/cross.h"

namespace curvecast {
namespace {

/// Twice the signed area of the part of a circle about the origin that is seen from there between p and q.
double sector(const Vec2d& p, const Vec2d& q, double square_radius) { return square_radius * std::atan2(cross(p, q), p.dot(q)); }

/// Twice the signed area of the triangle 0, p, q within the circle.
double part_in_circle(const Vec2d& p, const Vec2d& q, double square_radius) {
  // Where the line p + t (q - p) crosses the circle.
  const Vec2d d = q - p;
  const double a = d.squaredNorm(), b = p.dot(d), c = p.squaredNorm() - square_radius;
  const double discriminant = b * b - a * c;
  if (!(a > 0)) return 0;
  if (discriminant <= 0) return sector(p, q, square_radius);
  const double root = std::sqrt(discriminant);
  const double enter = (-b - root) / a, leave = (-b + root) / a;
  if (enter >= 1 || leave <= 0) return sector(p, q, square_radius);
  const Vec2d from = enter > 0 ? Vec2d(p + enter * d) : p, to = leave < 1 ? Vec2d(p + leave * d) : q;
  double sum = cross(from, to);
  if (enter > 0) sum += sector(p, from, square_radius);
  if (leave < 1) sum += sector(to, q, square_radius);
  return sum;
}

}  // namespace

double area_in_ball(const Vec3d& centre, double radius, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (!(length > 0)) return 0;
  const double height = (a - centre).dot(normal) / length;
  const double square_radius = radius * radius - height * height;
  if (square_radius <= 0) return 0;
  const Vec3d u = (b - a).normalized(), v = normal.cross(u) / length;
  const auto in_plane = [&](const Vec3d& p) { return Vec2d((p - centre).dot(u), (p - centre).dot(v)); };
  const Vec2d p = in_plane(a), q = in_plane(b), r = in_plane(c);
  const double twice =
      part_in_circle(p, q, square_radius) + part_in_circle(q, r, square_radius) + part_in_circle(r, p, square_radius);
  return std::clamp(0.5 * twice, 0.0, 0.5 * length);
}

}  // namespace curvecast
