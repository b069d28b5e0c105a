// A chart's triangles as the stages of the curve want them: one cache line each, all that is asked of a triangle in the square.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/column.h"
#include "core/base/vec.h"
#include "core/flatten/flatten.h"

namespace curvecast {

struct alignas(64) ParameterTriangle {
  double u[3], v[3];     // corners in [0, 1]^2, counter-clockwise
  double inverse_area2;  // 1 / (twice the uv area)
  double area_ratio;     // surface area over uv area

  double uv_area() const { return 0.5 / inverse_area2; }
  /// Barycentric coordinates of a point, or of several in lanes; each positive inside.
  template <typename Number>
  [[gnu::always_inline]] void weights(const Number& pu, const Number& pv, Number (&w)[3]) const {
    const Number u0 = u[0] - pu, u1 = u[1] - pu, u2 = u[2] - pu;
    const Number v0 = v[0] - pv, v1 = v[1] - pv, v2 = v[2] - pv;
    w[0] = (u1 * v2 - v1 * u2) * inverse_area2;
    w[1] = (u2 * v0 - v2 * u0) * inverse_area2;
    w[2] = 1 - w[0] - w[1];
  }
  Vec3d weights(double pu, double pv) const {
    double w[3];
    weights(pu, pv, w);
    return {w[0], w[1], w[2]};
  }
};

/// One for each triangle of the disc. Precondition: the chart is valid, no triangle is flipped or empty.
Column<ParameterTriangle> parameter_triangles(const Chart& chart);

/// Tells whether the triangles fill the square to its sides, as every chart with a square border does.
bool fill_square(std::span<const ParameterTriangle> triangles);

}  // namespace curvecast
