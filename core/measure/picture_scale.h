// How large lengths on a surface look to cameras: what weighs distances by depth (paper, section 4.5).
#pragma once

#include <span>
#include <vector>

#include "core/density/camera.h"

namespace curvecast {

class PictureScale {
 public:
  /// Precondition: check_camera() finds nothing.
  explicit PictureScale(std::span<const Camera> cameras);

  /// Pixels for a length of 1 at p, across the view, in the picture that shows it largest; 0: no picture has p. What hides p does
  /// not matter.
  double pixels(const Vec3d& p) const;

 private:
  struct View {
    Camera camera;
    CameraAxes axes;
    double tangent;  // of half the angle of view
    double pixels;   // at a depth of 1
  };
  std::vector<View> views_;
};

}  // namespace curvecast
