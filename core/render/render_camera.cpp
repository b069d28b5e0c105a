#include "core/render/render_camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace curvecast {
namespace {

bool is_positive(double value) { return std::isfinite(value) && value > 0; }

// Unit axes of the camera: x to the right, y up, z from the cloud to the eye.
struct Axes {
  Vec3d x, y, z;
};

Axes camera_axes(const FitOptions& options) {
  const FitOptions defaults;
  Axes axes;
  const double length = options.direction.stableNorm();
  axes.z = is_positive(length) ? Vec3d(options.direction / length) : Vec3d(defaults.direction.normalized());
  const double up_length = options.up.stableNorm();
  Vec3d up = is_positive(up_length) ? Vec3d(options.up / up_length) : defaults.up;
  if (up.cross(axes.z).norm() < 1e-3) {
    Eigen::Index smallest = 0;
    axes.z.cwiseAbs().minCoeff(&smallest);
    up = Vec3d::Unit(smallest);
  }
  axes.x = up.cross(axes.z).normalized();
  axes.y = axes.z.cross(axes.x);
  return axes;
}

// For the planes of the picture's left and right side (or bottom and top), with t the tangent of half the angle: a point with
// coordinates x and z is inside when x <= t (d - z) + c and -x <= t (d - z) - c, for an eye at c, d.
struct Slab {
  double plus = -std::numeric_limits<double>::infinity();
  double minus = -std::numeric_limits<double>::infinity();

  void extend(double x, double depth) {
    plus = std::max(plus, x + depth);
    minus = std::max(minus, -x + depth);
  }
  double distance(double t) const { return (plus + minus) / (2 * t); }
  double center() const { return (plus - minus) / 2; }
};

template <class Point>
RenderCamera fit(std::span<const Point> points, const FitOptions& options) {
  const FitOptions defaults;
  const Axes axes = camera_axes(options);
  const double fov = options.vertical_fov_degrees;
  const double margin = options.margin >= 0 && options.margin <= 0.45 ? options.margin : defaults.margin;
  RenderCamera camera;
  camera.vertical_fov_degrees = fov > 0 && fov < 180 ? fov : defaults.vertical_fov_degrees;
  camera.up = axes.y;
  const double half = camera.vertical_fov_degrees * (std::numbers::pi / 360);
  const double ty = std::tan(half) * (1 - 2 * margin);
  const double tx = ty * (is_positive(options.aspect) ? options.aspect : defaults.aspect);

  Slab horizontal, vertical;
  double front = -std::numeric_limits<double>::infinity();
  double back = std::numeric_limits<double>::infinity();
  for (const Point& point : points) {
    const Vec3d& p = point.template cast<double>();
    if (!p.allFinite()) continue;
    const double z = axes.z.dot(p);
    horizontal.extend(axes.x.dot(p), tx * z);
    vertical.extend(axes.y.dot(p), ty * z);
    front = std::max(front, z);
    back = std::min(back, z);
  }
  if (front < back) {
    camera.target = Vec3d::Zero();
    camera.eye = axes.z;
    return camera;
  }
  const Vec3d center = axes.x * horizontal.center() + axes.y * vertical.center();
  const double middle = 0.5 * (front + back);
  double distance = std::max(horizontal.distance(tx), vertical.distance(ty));
  // A single point, or points on one ray, leave no distance of their own.
  const double depth = front - back;
  double least = 1e-6 * std::max(std::abs(middle), center.norm());
  if (!(least > 0)) least = 1e-6;
  if (distance - front < std::max(1e-3 * depth, least)) distance = front + (depth > least ? depth : 1e6 * least);
  camera.target = center + axes.z * middle;
  camera.eye = center + axes.z * distance;
  return camera;
}

}  // namespace

RenderCamera fit_camera(std::span<const Vec3f> points, const FitOptions& options) { return fit(points, options); }

RenderCamera fit_camera(const Box3d& box, const FitOptions& options) {
  std::array<Vec3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    corners[static_cast<std::size_t>(i)] =
        Vec3d(i & 1 ? box.max.x() : box.min.x(), i & 2 ? box.max.y() : box.min.y(), i & 4 ? box.max.z() : box.min.z());
  }
  return fit(std::span<const Vec3d>(corners), options);
}

}  // namespace curvecast
