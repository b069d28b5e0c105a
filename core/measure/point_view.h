// Points where they lie, whatever holds them.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/vec.h"

namespace curvecast {

/// Coordinates of point i are x[i * stride], y[i * stride], z[i * stride].
struct PointView {
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t size = 0;
  std::size_t stride = 1;
};
PointView view_of(std::span<const float> x, std::span<const float> y, std::span<const float> z);
PointView view_of(std::span<const Vec3f> points);

}  // namespace curvecast
