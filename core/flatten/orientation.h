// Exact sign of a triangle's area in the plane.
#pragma once

#include "core/base/vec.h"

namespace curvecast {

/// 1 when a, b, c turn counter-clockwise, -1 when clockwise, 0 when they lie on one line: of the given doubles, without rounding.
int orientation(const Vec2d& a, const Vec2d& b, const Vec2d& c);

}  // namespace curvecast
