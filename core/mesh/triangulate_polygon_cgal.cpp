#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include "core/mesh/triangulate_polygon.h"

namespace curvecast {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

void triangulate_quad(std::span<const Vec3d> p, std::vector<Triangle>& triangles) {
  // The quad's normal; a diagonal is good when both of its triangles agree with it.
  const Vec3d normal = (p[2] - p[0]).cross(p[3] - p[1]);
  const auto facing = [&](int a, int b, int c) { return (p[b] - p[a]).cross(p[c] - p[a]).dot(normal); };
  const double fold02 = std::min(facing(0, 1, 2), facing(0, 2, 3));
  const double fold13 = std::min(facing(0, 1, 3), facing(1, 2, 3));
  const bool good02 = fold02 > 0;
  const bool good13 = fold13 > 0;
  const bool shorter02 = (p[2] - p[0]).squaredNorm() <= (p[3] - p[1]).squaredNorm();
  if (good02 != good13 ? good02 : shorter02) {
    triangles.push_back({0, 1, 2});
    triangles.push_back({0, 2, 3});
  } else {
    triangles.push_back({0, 1, 3});
    triangles.push_back({1, 2, 3});
  }
}

/// CGAL's answer, or nothing where it finds none.
std::vector<Triangle> triangulate_large(std::span<const Vec3d> corners) {
  std::vector<Triangle> triangles;
  try {
    std::vector<Kernel::Point_3> polyline;
    polyline.reserve(corners.size());
    for (const Vec3d& p : corners) polyline.emplace_back(p.x(), p.y(), p.z());
    std::vector<CGAL::Triple<int, int, int>> patch;
    CGAL::Polygon_mesh_processing::triangulate_hole_polyline(polyline, std::back_inserter(patch));
    for (const auto& t : patch) {
      triangles.push_back({static_cast<std::uint32_t>(t.first), static_cast<std::uint32_t>(t.second),
                           static_cast<std::uint32_t>(t.third)});
    }
  } catch (const std::exception&) {
    triangles.clear();
  }
  return triangles.size() == corners.size() - 2 ? triangles : std::vector<Triangle>{};
}

/// A patch for a hole is oriented against its border; the polygon's own triangles go along with it.
void orient_along_border(std::size_t n, std::vector<Triangle>& triangles) {
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i];
      const std::uint32_t b = t[(i + 1) % 3];
      if ((a + 1) % n == b) return;
      if ((b + 1) % n == a) {
        for (Triangle& u : triangles) std::swap(u[1], u[2]);
        return;
      }
    }
  }
}

}  // namespace

void triangulate_polygon(std::span<const Vec3d> corners, std::vector<Triangle>& triangles) {
  const std::size_t n = corners.size();
  if (n == 3) {
    triangles.push_back({0, 1, 2});
  } else if (n == 4) {
    triangulate_quad(corners, triangles);
  } else {
    std::vector<Triangle> patch = triangulate_large(corners);
    orient_along_border(n, patch);
    if (patch.empty()) {
      for (std::uint32_t i = 1; i + 1 < n; ++i) patch.push_back({0, i, i + 1});
    }
    triangles.insert(triangles.end(), patch.begin(), patch.end());
  }
}

}  // namespace curvecast
