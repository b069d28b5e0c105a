// A chart's triangles as the stages of the curve want them: one cache line each, all that is asked of a triangle in the square.
#pragma once

#include <cstdint>
#include <span>

#include "core/column.h"
#include "core/flatten/flatten.h"
#include "core/vec.h"

namespace curvecast {

struct alignas(64) ParameterTriangle {
  double u[3], v[3];     // corners in [0, 1]^2, counter-clockwise
  double inverse_area2;  // 1 / (twice the uv area)
  double area_ratio;     // surface area over uv area

  double uv_area() const { return 0.5 / inverse_area2; }
  /// Barycentric coordinates of a point; each positive inside.
  Vec3d weights(double pu, double pv) const {
    const double u0 = u[0] - pu, u1 = u[1] - pu, u2 = u[2] - pu;
    const double v0 = v[0] - pv, v1 = v[1] - pv, v2 = v[2] - pv;
    const double w0 = (u1 * v2 - v1 * u2) * inverse_area2;
    const double w1 = (u2 * v0 - v2 * u0) * inverse_area2;
    return {w0, w1, 1 - w0 - w1};
  }
};

/// One for each triangle of the disc. Precondition: the chart is valid, no triangle is flipped or empty.
Column<ParameterTriangle> parameter_triangles(const Chart& chart);

/// Whether the triangles fill the square to its sides, as every chart with a square border does.
bool fill_square(std::span<const ParameterTriangle> triangles);

}  // namespace curvecast
