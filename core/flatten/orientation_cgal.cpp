#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "core/flatten/orientation.h"

namespace curvecast {

int orientation(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  return static_cast<int>(CGAL::orientation(Point(a.x(), a.y()), Point(b.x(), b.y()), Point(c.x(), c.y())));
}

}  // namespace curvecast
