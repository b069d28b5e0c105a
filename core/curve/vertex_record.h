// What the mapper mixes of a mesh vertex, in a form that mixes linearly.
#pragma once

#include "core/curve/tangent_frame.h"
#include "core/mesh/curvature.h"

namespace curvecast {

/// A normal, the curvatures, and the axis of the direction of curvature_max as a tensor (AxisTensor). Made where it is mixed:
/// kept for every vertex it would be larger than the geometry.
struct VertexRecord {
  static constexpr int kNormal = 0, kCurvatureMin = 3, kCurvatureMax = 4, kAxis = 5, kSize = 11;  // where they begin

  float values[kSize];

  /// The first `numbers` of them, 3 or all; the others are left as they are.
  template <int numbers>
  [[gnu::always_inline]] void set(const VertexGeometry& vertex, const Vec3f& normal) {
    for (int k = 0; k < 3; ++k) values[kNormal + k] = normal[k];
    if constexpr (numbers > 3) {
      values[kCurvatureMin] = vertex.curvature_min;
      values[kCurvatureMax] = vertex.curvature_max;
      const AxisTensor axis = axis_tensor(vertex.direction_max);
      for (int k = 0; k < 6; ++k) values[kAxis + k] = axis[static_cast<std::size_t>(k)];
    }
  }
};

}  // namespace curvecast
