// Where a picture is taken from.
#pragma once

#include <span>

#include "core/base/vec.h"

namespace curvecast {

/// Perspective camera, in mesh units.
struct RenderCamera {
  Vec3d eye = Vec3d(0, 0, 1);
  Vec3d target = Vec3d::Zero();
  Vec3d up = Vec3d(0, 1, 0);         // any length; not along eye - target
  double vertical_fov_degrees = 30;  // > 0, < 180
};

struct FitOptions {
  Vec3d direction = Vec3d(0.55, 0.35, 1);  // from the cloud to the eye, any length: a three-quarter view
  Vec3d up = Vec3d(0, 1, 0);               // replaced by another axis when it is along `direction`
  double vertical_fov_degrees = 30;        // > 0, < 180
  double aspect = 4.0 / 3.0;               // width / height of the picture, > 0
  double margin = 0.08;                    // share of the picture left free on every side, 0 .. 0.45
};

/// The nearest camera looking along -direction that has all points in its picture, with the margin kept free and the cloud in the
/// middle. Coordinates that are not finite are ignored, bad options replaced by their defaults; without points the camera looks
/// at the origin from one unit away.
RenderCamera fit_camera(std::span<const Vec3f> points, const FitOptions& options = {});

/// Fits a camera to the eight corners of a box.
RenderCamera fit_camera(const Box3d& box, const FitOptions& options = {});

}  // namespace curvecast
