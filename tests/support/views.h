// Densities as seen from one place.
#pragma once

#include <utility>
#include <vector>

#include "core/density/density.h"

namespace curvecast::testing {

/// A perspective camera that looks at `target`, or past it where it stands there itself.
inline Camera camera_at(const Vec3d& eye, const Vec3d& target = Vec3d::Zero()) {
  Camera camera{.eye = eye, .target = eye == target ? Vec3d(target + Vec3d::UnitZ()) : target};
  const Vec3d ahead = 0.5 * camera.target - 0.5 * camera.eye;
  const Vec3d along = ahead / ahead.cwiseAbs().maxCoeff();
  if (along.cross(camera.up).norm() < 0.1) camera.up = Vec3d::UnitX();
  return camera;
}

inline Density seen_from(const Vec3d& eye, std::vector<DensityTerm> terms = {ViewTerm{}}) {
  return Density(std::move(terms), {camera_at(eye)});
}

}  // namespace curvecast::testing
