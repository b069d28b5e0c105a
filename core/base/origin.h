// Where positions in floats are relative to.
#pragma once

#include <algorithm>

#include "core/base/vec.h"

namespace curvecast {

/// The box's centre if floats would be too coarse so far out, else zero: then positions are those of the file.
inline Vec3d choose_origin(const Box3d& box) {
  constexpr double kFarOut = 100;
  const double reach = std::max(box.min.norm(), box.max.norm());
  return reach > kFarOut * box.diagonal() ? box.center() : Vec3d(Vec3d::Zero());
}

}  // namespace curvecast
