// The one list of a curve's columns: who resizes, counts, saves or loads them goes through it.
#pragma once

#include "core/curve/surface_curve.h"

namespace curvecast {

enum class ColumnLength {
  kAll,        // L entries
  kAllOrNone,  // L entries, or none where the curve has no such thing
};

/// Calls visit(name, column, length) with every column but the scalars. The names are those in files.
template <typename Curve, typename Visit>
void visit_columns(Curve& curve, Visit&& visit) {
  visit("x", curve.x, ColumnLength::kAll);
  visit("y", curve.y, ColumnLength::kAll);
  visit("z", curve.z, ColumnLength::kAll);
  visit("normal x", curve.nx, ColumnLength::kAll);
  visit("normal y", curve.ny, ColumnLength::kAll);
  visit("normal z", curve.nz, ColumnLength::kAll);
  visit("least curvature", curve.curvature_min, ColumnLength::kAll);
  visit("greatest curvature", curve.curvature_max, ColumnLength::kAll);
  visit("direction", curve.direction, ColumnLength::kAll);
  visit("area", curve.area, ColumnLength::kAll);
  visit("colour", curve.colour, ColumnLength::kAllOrNone);
  visit("triangle", curve.triangle, ColumnLength::kAll);
  visit("weight 1", curve.weight_1, ColumnLength::kAll);
  visit("weight 2", curve.weight_2, ColumnLength::kAll);
  visit("key", curve.key, ColumnLength::kAll);
  visit("level", curve.level, ColumnLength::kAll);
}

}  // namespace curvecast
