#include "core/measure/picture_scale.h"

#include <algorithm>
#include <cmath>

namespace curvecast {

PictureScale::PictureScale(std::span<const Camera> cameras) {
  for (const Camera& camera : cameras) {
    views_.push_back({camera, axes_of(camera), std::tan(camera.fov / 2), pixels_at_unit_depth(camera)});
  }
}

double PictureScale::pixels(const Vec3d& p) const {
  double most = 0;
  for (const auto& [camera, axes, tangent, pixels] : views_) {
    const Vec3d from_eye = p - camera.eye;
    const double depth = from_eye.dot(axes.forward);
    const double half = camera.is_orthographic() ? camera.height / 2 : depth * tangent;  // the picture's half height there
    if (!(half > 0) || std::abs(from_eye.dot(axes.up)) > half) continue;
    if (std::abs(from_eye.dot(axes.right)) > half * camera.aspect) continue;
    most = std::max(most, camera.is_orthographic() ? pixels : pixels / depth);
  }
  return most;
}

}  // namespace curvecast
