// The one list of a curve's columns: who resizes, counts, copies, saves or loads them goes through it.
#pragma once

#include "core/curve/surface_curve.h"

namespace curvecast {

enum class ColumnLength {
  kAll,        // L entries
  kAllOrNone,  // L entries, or none where the curve has no such thing
};

/// Calls visit(name, member, length) with every column but the scalars, as a pointer to a member of SurfaceCurve: for those who
/// go through several curves at once. The names are those in files.
template <typename Visit>
void visit_column_members(Visit&& visit) {
  visit("x", &SurfaceCurve::x, ColumnLength::kAll);
  visit("y", &SurfaceCurve::y, ColumnLength::kAll);
  visit("z", &SurfaceCurve::z, ColumnLength::kAll);
  visit("normal x", &SurfaceCurve::nx, ColumnLength::kAll);
  visit("normal y", &SurfaceCurve::ny, ColumnLength::kAll);
  visit("normal z", &SurfaceCurve::nz, ColumnLength::kAll);
  visit("least curvature", &SurfaceCurve::curvature_min, ColumnLength::kAll);
  visit("greatest curvature", &SurfaceCurve::curvature_max, ColumnLength::kAll);
  visit("direction", &SurfaceCurve::direction, ColumnLength::kAll);
  visit("area", &SurfaceCurve::area, ColumnLength::kAll);
  visit("normal beside", &SurfaceCurve::beside, ColumnLength::kAllOrNone);
  visit("colour", &SurfaceCurve::colour, ColumnLength::kAllOrNone);
  visit("triangle", &SurfaceCurve::triangle, ColumnLength::kAll);
  visit("weight 1", &SurfaceCurve::weight_1, ColumnLength::kAll);
  visit("weight 2", &SurfaceCurve::weight_2, ColumnLength::kAll);
  visit("key", &SurfaceCurve::key, ColumnLength::kAll);
  visit("level", &SurfaceCurve::level, ColumnLength::kAll);
}

/// Calls visit(name, column, length) with every column of a curve but the scalars.
template <typename Curve, typename Visit>
void visit_columns(Curve& curve, Visit&& visit) {
  visit_column_members([&](const char* name, auto member, ColumnLength length) { visit(name, curve.*member, length); });
}

}  // namespace curvecast
