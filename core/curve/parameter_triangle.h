// A chart's triangles as the stages of the curve want them: all at once, one cache line each, for what visits all of them; or one
// by one, made where they are asked for. A surface keeps none: they would take as much memory as all the rest of it.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/column.h"
#include "core/base/vec.h"
#include "core/flatten/chart_view.h"
#include "core/flatten/distortion.h"

namespace curvecast {

/// All that is asked of a triangle in the square.
struct UvTriangle {
  double u[3], v[3];     // corners in [0, 1]^2, counter-clockwise
  double inverse_area2;  // 1 / (twice the uv area)

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

struct alignas(64) ParameterTriangle : UvTriangle {
  double area_ratio;  // surface area over uv area
};

/// The triangles of a chart, which outlives it. Precondition: the chart is valid, no triangle is flipped or empty.
class ChartTriangles {
 public:
  explicit ChartTriangles(const ChartView& chart) : chart_(chart) {}

  std::size_t size() const { return chart_.triangles.size(); }
  [[gnu::always_inline]] UvTriangle operator[](std::size_t t) const {
    UvTriangle out;
    for (int i = 0; i < 3; ++i) {
      const Vec2d& corner = chart_.uv[chart_.triangles[t][i]];
      out.u[i] = corner.x();
      out.v[i] = corner.y();
    }
    out.inverse_area2 = 1 / ((out.u[1] - out.u[0]) * (out.v[2] - out.v[0]) - (out.v[1] - out.v[0]) * (out.u[2] - out.u[0]));
    return out;
  }
  double area_ratio(std::size_t t) const { return curvecast::area_ratio(chart_, t); }
  ParameterTriangle whole(std::size_t t) const { return {(*this)[t], area_ratio(t)}; }

 private:
  ChartView chart_;
};

/// One for each triangle of the disc. Precondition: as of ChartTriangles.
Column<ParameterTriangle> parameter_triangles(const ChartView& chart);

/// Tells whether the triangles fill the square to its sides, as every chart with a square border does.
bool fill_square(std::span<const ParameterTriangle> triangles);
bool fill_square(const ChartTriangles& triangles);

}  // namespace curvecast
