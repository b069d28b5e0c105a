#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

/// Calls `visit` with every column that always has L entries.
template <typename Curve, typename Visit>
void visit_columns(Curve& curve, Visit&& visit) {
  visit(curve.x), visit(curve.y), visit(curve.z);
  visit(curve.nx), visit(curve.ny), visit(curve.nz);
  visit(curve.curvature_min), visit(curve.curvature_max);
  visit(curve.direction), visit(curve.area);
  visit(curve.triangle), visit(curve.weight_1), visit(curve.weight_2);
  visit(curve.key), visit(curve.level);
}

}  // namespace

void SurfaceCurve::resize(std::size_t n, bool has_colour) {
  visit_columns(*this, [n](auto& column) { column.resize(n); });
  if (has_colour) colour.resize(n);
  for (ScalarColumn& scalar : scalars) scalar.values.resize(n);
}

std::size_t SurfaceCurve::byte_size() const {
  std::size_t bytes = disc_begin.size() * sizeof(std::uint32_t) + hierarchy.byte_size();
  const auto add = [&bytes](const auto& column) { bytes += column.size() * sizeof(column[0]); };
  visit_columns(*this, add);
  add(colour);
  for (const ScalarColumn& scalar : scalars) add(scalar.values);
  return bytes;
}

}  // namespace curvecast
