#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>

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

/// Returns the polygon as seen along the axis that is nearest to its normal; nothing where it has no normal.
std::vector<Kernel::Point_2> flatten(std::span<const Vec3d> corners) {
  Vec3d normal = Vec3d::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  }
  int axis = 0;
  if (!(normal.cwiseAbs().maxCoeff(&axis) > 0)) return {};
  std::vector<Kernel::Point_2> outline;
  outline.reserve(corners.size());
  for (const Vec3d& p : corners) outline.emplace_back(p[(axis + 1) % 3], p[(axis + 2) % 3]);
  return outline;
}

/// CGAL's answer, or nothing where it finds none.
std::vector<Triangle> triangulate_large(std::span<const Vec3d> corners) {
  std::vector<Triangle> triangles;
  try {
    // Of a polygon that crosses or touches itself CGAL makes faces that have no end. It looks along a normal of its own, from
    // where a polygon that is not planar may cross itself; so it is given the flat one that was tested.
    const std::vector<Kernel::Point_2> outline = flatten(corners);
    if (outline.empty() || !CGAL::is_simple_2(outline.begin(), outline.end(), Kernel())) return {};
    CGAL::Surface_mesh<Kernel::Point_3> mesh;
    std::vector<CGAL::SM_Vertex_index> polygon;
    polygon.reserve(corners.size());
    for (const Kernel::Point_2& p : outline) polygon.push_back(mesh.add_vertex(Kernel::Point_3(p.x(), p.y(), 0)));
    mesh.add_face(polygon);
    if (!CGAL::Polygon_mesh_processing::triangulate_faces(mesh)) return {};
    for (const CGAL::SM_Face_index f : mesh.faces()) {
      Triangle triangle{};
      int i = 0;
      for (const CGAL::SM_Vertex_index v : mesh.vertices_around_face(mesh.halfedge(f))) {
        if (i == 3) return {};
        triangle[i++] = static_cast<std::uint32_t>(v);
      }
      if (i != 3) return {};
      triangles.push_back(triangle);
    }
  } catch (const std::exception&) {
    return {};
  }
  return triangles.size() == corners.size() - 2 ? triangles : std::vector<Triangle>{};
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
    if (patch.empty()) {
      for (std::uint32_t i = 1; i + 1 < n; ++i) patch.push_back({0, i, i + 1});
    }
    triangles.insert(triangles.end(), patch.begin(), patch.end());
  }
}

}  // namespace curvecast
