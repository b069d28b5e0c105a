// Meshes and points for the tests of remeshing, and what holds of every mesh that comes of it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/measure/random_surface_points.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_mesh.h"
#include "core/remesh/halfedge_mesh.h"
#include "core/sample/point_set.h"
#include "tests/support/shapes.h"

namespace curvecast::testing {

/// What is left of a mesh.
inline TriangleMesh compacted(HalfedgeMesh mesh) {
  mesh.compact();
  return mesh;
}

/// Random places, uniform in area.
inline std::vector<FacePlace> random_places(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed = 7) {
  const SurfacePoints points = random_surface_points(mesh, n, seed);
  std::vector<FacePlace> places;
  for (std::size_t i = 0; i < n; ++i) {
    const Triangle& t = mesh.triangles[points.faces[i]];
    const Vec3d &a = mesh.positions[t[0]], b = mesh.positions[t[1]] - a, c = mesh.positions[t[2]] - a,
                p = points.positions[i] - a;
    const double bb = b.dot(b), bc = b.dot(c), cc = c.dot(c), determinant = bb * cc - bc * bc;
    places.push_back({points.faces[i], static_cast<float>((cc * p.dot(b) - bc * p.dot(c)) / determinant),
                      static_cast<float>((bb * p.dot(c) - bc * p.dot(b)) / determinant)});
    places.back().weight_1 = std::clamp(places.back().weight_1, 0.0f, 1.0f);
    places.back().weight_2 = std::clamp(places.back().weight_2, 0.0f, 1.0f - places.back().weight_1);
  }
  return places;
}

/// Shapes of genus 0 to 8 with 0 to 5 borders.
inline std::vector<std::pair<std::string, TriangleMesh>> remesh_shapes() {
  std::vector<std::pair<std::string, TriangleMesh>> shapes;
  const auto add = [&](std::string name, const PolygonSoup& soup) { shapes.emplace_back(std::move(name), make_mesh(soup)); };
  add("ball", icosphere(4));
  add("torus", jittered(torus(40, 24), 0.01));
  add("disc", disc(20, 40));
  add("cylinder", open_cylinder(20, 30));
  add("two balls", merged(icosphere(3), translated(icosphere(3), {3, 0, 0})));
  for (const int holes : {1, 2, 4, 8}) {
    add("slab of genus " + std::to_string(holes), perforated_slab(2 * holes + 1, 3));
  }
  for (const std::size_t borders : {1u, 3u, 5u}) {
    // Of a slab of genus 2 every so manieth outer quad is left out.
    const PolygonSoup slab = perforated_slab(5, 9);
    const std::size_t step = slab.polygon_count() / borders;
    add("open slab", filtered(slab, [&](std::size_t p) { return p % step != step / 2; }));
  }
  return shapes;
}

/// Says what is wrong with a mesh's connectivity.
inline void expect_manifold(const TriangleMesh& mesh) {
  ASSERT_EQ(mesh.twins.size(), 3 * mesh.face_count());
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.triangles[h / 3][0] == kNone) continue;
    ASSERT_LT(mesh.from(h), mesh.vertex_count());
    ASSERT_NE(mesh.from(h), mesh.to(h));
    const std::uint32_t t = mesh.twins[h];
    if (t == kNone) continue;
    ASSERT_EQ(mesh.twins[t], h);
    ASSERT_EQ(mesh.from(t), mesh.to(h));
    ASSERT_EQ(mesh.to(t), mesh.from(h));
  }
}

inline void expect_same_topology(const TriangleMesh& mesh, const TriangleMesh& as) {
  expect_manifold(mesh);
  std::vector<std::uint32_t> fans;
  EXPECT_EQ(label_fans(mesh.twins, fans), mesh.vertex_count()) << "a vertex with several fans";
  const Topology found = analyse_topology(mesh), wanted = analyse_topology(as);
  EXPECT_EQ(found.components, wanted.components);
  EXPECT_EQ(found.genus, wanted.genus);
  EXPECT_EQ(found.boundary_loops, wanted.boundary_loops);
}

/// The smallest angle of each triangle, in degrees, ascending.
inline std::vector<double> least_angles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  for (const Triangle& t : mesh.triangles) {
    if (t[0] == kNone) continue;
    double least = 180;
    for (int i = 0; i < 3; ++i) {
      const Vec3d& at = mesh.positions[t[i]];
      const Vec3d p = mesh.positions[t[(i + 1) % 3]] - at, q = mesh.positions[t[(i + 2) % 3]] - at;
      least = std::min(least, std::atan2(p.cross(q).norm(), p.dot(q)) * 180 / std::numbers::pi);
    }
    angles.push_back(least);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace curvecast::testing
