#include "core/density/camera_frame.h"

#include <algorithm>
#include <cmath>

#include "core/density/density.h"

namespace curvecast {
namespace {

// In diagonals: from there on rays are parallel.
constexpr double kFar = 1e6;
// Rounding of a float in calculations as short as these.
constexpr double kRounding = 1e-6;
// Stands for infinitely far inside: floats of such distances can still be added.
constexpr double kEndless = 1e30;

float bounded(double value) { return static_cast<float>(std::clamp(value, -kEndless, kEndless)); }

/// normal . (p - eye), in lengths, plus `inside`; finite for the farthest eye.
AffineForm distance_along(const Vec3d& normal, const Vec3d& eye, const Vec3d& origin, double length, double inside) {
  constexpr double kMost = 1e100;
  const Vec3d back = origin - eye;
  const double reach = std::max(length, back.cwiseAbs().maxCoeff());
  const Vec3d n = normal / length;
  return {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z()),
          bounded(normal.dot(back / reach) * std::min(reach / length, kMost) + inside)};
}

}  // namespace

CameraFrame::CameraFrame(const Camera& camera, const Vec3d& origin, const Box3d& box)
    : is_orthographic(camera.is_orthographic()), unit(box.diagonal()), box_distance(0), scale(1 / box.diagonal()) {
  const double diagonal = box.diagonal();
  const Vec3d center = box.center();
  const CameraAxes axes = axes_of(camera);
  const auto distance = [&](const Vec3d& normal, double inside) {
    return distance_along(normal, camera.eye, origin, diagonal, inside);
  };
  blur = static_cast<float>(kRounding * (1 + std::max((box.min - origin).norm(), (box.max - origin).norm()) / diagonal));
  if (is_orthographic) {
    x = static_cast<float>(-axes.forward.x()), y = static_cast<float>(-axes.forward.y()),
    z = static_cast<float>(-axes.forward.z());
    slope = 0;
    depth = {0, 0, 0, 1};
    depth_reach = 0;
    const double half = 0.5 * camera.height * scale;
    sides = {distance(axes.up, half), distance(-axes.up, half), distance(axes.right, half * camera.aspect),
             distance(-axes.right, half * camera.aspect), AffineForm{0, 0, 0, static_cast<float>(kEndless)}};
    return;
  }
  Vec3d from_center = camera.eye / diagonal - center / diagonal;
  double shrink = 1;  // of the distance
  if (const double reach = from_center.cwiseAbs().maxCoeff(); reach > kFar) {
    from_center = (camera.eye - center) / (camera.eye - center).cwiseAbs().maxCoeff() * kFar;
    shrink = kFar / reach;
  }
  unit = diagonal / shrink;
  const Vec3d to_box = camera.eye / unit - camera.eye.cwiseMax(box.min).cwiseMin(box.max) / unit;
  box_distance = to_box.stableNorm();
  const Vec3f eye = (from_center + (center - origin) / diagonal).cast<float>();
  x = eye.x(), y = eye.y(), z = eye.z();
  slope = static_cast<float>(scale);
  depth = distance_along(axes.forward, camera.eye, origin, unit, 0);
  depth_reach = static_cast<float>(1 / unit);
  const double up = std::tan(0.5 * camera.fov), right = up * camera.aspect;
  const double up_length = std::hypot(1, up), right_length = std::hypot(1, right);
  const auto side = [&](const Vec3d& outwards, double tangent, double length) {
    return distance((tangent * axes.forward - outwards) / length, 0);
  };
  sides = {side(axes.up, up, up_length), side(-axes.up, up, up_length), side(axes.right, right, right_length),
           side(-axes.right, right, right_length), distance(axes.forward, -kNearPlane)};
}

}  // namespace curvecast
