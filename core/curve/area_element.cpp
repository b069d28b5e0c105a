#include "core/curve/area_element.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <functional>

#include <array>

namespace curvecast {
namespace {

/// A convex polygon small enough for a triangle clipped by four lines.
struct Polygon {
  std::array<Vec2d, 8> corner;
  int size = 0;

  void add(const Vec2d& p) { corner[size++] = p; }

  double area() const {
    double twice = 0;
    for (int i = 2; i < size; ++i) {
      const Vec2d p = corner[i - 1] - corner[0];
      const Vec2d q = corner[i] - corner[0];
      twice += p.x() * q.y() - p.y() * q.x();
    }
    return 0.5 * twice;
  }
};

/// Keeps the part where sign * (coordinate `axis` - bound) >= 0 (Sutherland and Hodgman).
Polygon clip(const Polygon& polygon, int axis, double bound, double sign) {
  Polygon inside;
  for (int i = 0; i < polygon.size; ++i) {
    const Vec2d& p = polygon.corner[i];
    const Vec2d& q = polygon.corner[(i + 1) % polygon.size];
    const double dp = sign * (p[axis] - bound);
    const double dq = sign * (q[axis] - bound);
    if (dp >= 0) inside.add(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
      Vec2d cut = p + (q - p) * (dp / (dp - dq));
      cut[axis] = bound;
      inside.add(cut);
    }
  }
  return inside;
}

double shared_area(const Quad& quad, const Vec2d& p, const Vec2d& q, const Vec2d& r) {
  // Relative to the quad's corner: no digits are lost on small leaves.
  Polygon polygon;
  polygon.add(p - quad.corner);
  polygon.add(q - quad.corner);
  polygon.add(r - quad.corner);
  for (const int axis : {0, 1}) {
    polygon = clip(clip(polygon, axis, 0, 1), axis, quad.side, -1);
    if (polygon.size < 3) return 0;
  }
  return polygon.area();
}

}  // namespace

double area_elements(const Chart& chart, const QuadtreeLeaves& leaves, std::span<float> area) {
  const auto write = [&](const tbb::blocked_range<std::size_t>& range, double total) {
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const Quad quad = leaf_quad(leaves.key[l], leaves.level[l]);
      const std::uint32_t begin = leaves.triangle_begin[l];
      const std::uint32_t end = leaves.triangle_begin[l + 1];
      double sum = 0;
      if (end - begin == 1) {
        sum = quad.side * quad.side * chart.area_ratio[leaves.triangles[begin]];
      } else {
        for (std::uint32_t i = begin; i < end; ++i) {
          const Triangle& t = chart.disc.triangles[leaves.triangles[i]];
          sum += shared_area(quad, chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]) * chart.area_ratio[leaves.triangles[i]];
        }
      }
      area[l] = static_cast<float>(sum);
      total += sum;
    }
    return total;
  };
  // The same order of additions on any number of threads.
  return tbb::parallel_deterministic_reduce(tbb::blocked_range<std::size_t>(0, leaves.size(), 4096), 0.0, write, std::plus<>());
}

}  // namespace curvecast
