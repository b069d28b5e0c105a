#include "core/measure/point_view.h"

namespace curvecast {

PointView view_of(std::span<const float> x, std::span<const float> y, std::span<const float> z) {
  return {x.data(), y.data(), z.data(), x.size(), 1};
}

PointView view_of(std::span<const Vec3f> points) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  if (points.empty()) return {};
  const float* first = points.front().data();
  return {first, first + 1, first + 2, points.size(), 3};
}

}  // namespace curvecast
