#include "core/mesh/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

struct Expected {
  std::string name;
  PolygonSoup soup;
  std::uint32_t components, boundary_loops, genus;
};

std::vector<Expected> shapes() {
  const auto far = [](const PolygonSoup& soup) { return translated(soup, {100, 0, 0}); };
  std::vector<Expected> all = {
      {"triangle", single_triangle(), 1, 1, 0},
      {"disc", disc(4, 9), 1, 1, 0},
      {"sphere", sphere(7, 9), 1, 0, 0},
      {"icosphere", icosphere(2), 1, 0, 0},
      {"tetrahedron", tetrahedron(), 1, 0, 0},
      {"cube", cube(), 1, 0, 0},
      {"torus", torus(8, 7), 1, 0, 1},
      {"cylinder", open_cylinder(5, 8), 1, 2, 0},
      {"two spheres", merged(sphere(5, 7), far(sphere(6, 8))), 2, 0, 0},
      {"all sorts", merged(merged(torus(7, 7), far(perforated_slab(5, 5))), translated(disc(3, 7), {0, 100, 0})), 3, 1, 5},
      // Faces far from one another taken out of closed surfaces.
      {"sphere with 3 holes", filtered(icosphere(3), [](std::size_t p) { return p != 0 && p != 400 && p != 900; }), 1, 3, 0},
      {"torus with 2 holes", filtered(torus(12, 12), [](std::size_t p) { return p != 0 && p != 150; }), 1, 2, 1},
  };
  for (const int g : {1, 2, 3, 7}) {
    const auto genus = static_cast<std::uint32_t>(g);
    all.push_back({"slab of genus " + std::to_string(g), perforated_slab(2 * g + 1, 3), 1, 0, genus});
    all.push_back({"slab of genus " + std::to_string(2 * g), perforated_slab(2 * g + 1, 5), 1, 0, 2 * genus});
  }
  return all;
}

TEST(Topology, OfEveryShape) {
  for (const Expected& shape : shapes()) {
    const Topology topology = analyse_topology(make_mesh(shape.soup));
    EXPECT_EQ(topology.components, shape.components) << shape.name;
    EXPECT_EQ(topology.boundary_loops, shape.boundary_loops) << shape.name;
    EXPECT_EQ(topology.genus, shape.genus) << shape.name;
  }
}

TEST(Topology, HoldsEulersFormulaWithEdgesCountedByTheirEnds) {
  for (const Expected& shape : shapes()) {
    const TriangleMesh mesh = make_mesh(shape.soup);
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      edges.insert({std::min(mesh.from(h), mesh.to(h)), std::max(mesh.from(h), mesh.to(h))});
    }
    const Topology t = analyse_topology(mesh);
    const auto characteristic =
        static_cast<int>(mesh.vertex_count()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.face_count());
    EXPECT_EQ(characteristic,
              2 * static_cast<int>(t.components) - 2 * static_cast<int>(t.genus) - static_cast<int>(t.boundary_loops))
        << shape.name;
  }
}

TEST(Topology, NumbersComponentsByTheirFirstFace) {
  // The faces of three spheres, interleaved.
  const PolygonSoup one = sphere(5, 6);
  const PolygonSoup all = merged(merged(one, translated(one, {3, 0, 0})), translated(one, {6, 0, 0}));
  const std::size_t faces = one.polygon_count();
  std::vector<std::vector<std::uint32_t>> polygons;
  for (std::size_t i = 0; i < 3 * faces; ++i) {
    const std::size_t p = (i % 3) * faces + i / 3;
    polygons.push_back({all.indices[3 * p], all.indices[3 * p + 1], all.indices[3 * p + 2]});
  }
  const Topology topology = analyse_topology(make_mesh(soup_of(all.positions, polygons)));
  EXPECT_EQ(topology.components, 3u);
  ASSERT_EQ(topology.component_of_face.size(), 3 * faces);
  for (std::size_t f = 0; f < 3 * faces; ++f) EXPECT_EQ(topology.component_of_face[f], f % 3) << "face " << f;
}

TEST(Topology, LabelsOneFanPerVertex) {
  for (const Expected& shape : shapes()) {
    const TriangleMesh mesh = make_mesh(shape.soup);
    std::vector<std::uint32_t> fan;
    EXPECT_EQ(label_fans(mesh.twins, fan), mesh.vertex_count()) << shape.name;
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;  // (vertex, fan): one to one
    std::uint32_t next = 0;
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      pairs.insert({mesh.from(h), fan[h]});
      EXPECT_LE(fan[h], next) << shape.name;  // numbered by first corner
      next = std::max(next, fan[h] + 1);
    }
    EXPECT_EQ(pairs.size(), mesh.vertex_count()) << shape.name;
  }
}

TEST(Topology, WalksBordersWithTheSurfaceOnTheLeft) {
  const TriangleMesh mesh = make_mesh(disc(4, 11));
  const auto start = static_cast<std::uint32_t>(std::find(mesh.twins.begin(), mesh.twins.end(), kNone) - mesh.twins.begin());
  double twice_area = 0;
  int steps = 0;
  std::uint32_t h = start;
  do {
    ASSERT_EQ(mesh.twins[h], kNone);
    const Vec3d &p = mesh.positions[mesh.from(h)], &q = mesh.positions[mesh.to(h)];
    twice_area += p.x() * q.y() - q.x() * p.y();
    const std::uint32_t following = next_on_border(mesh.twins, h);
    ASSERT_EQ(mesh.from(following), mesh.to(h));
    h = following;
  } while (h != start && ++steps < 100);
  EXPECT_EQ(steps, 10);
  EXPECT_NEAR(0.5 * twice_area, surface_area(mesh), 1e-12);
}

}  // namespace
}  // namespace curvecast
