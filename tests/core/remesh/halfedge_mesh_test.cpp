#include "core/remesh/halfedge_mesh.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/remesh/insert_points.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// Compares all that the mesh knows of its vertices with what its faces say.
void expect_sound(const HalfedgeMesh& mesh) {
  expect_manifold(mesh);
  std::map<std::uint32_t, std::set<std::uint32_t>> neighbours;
  std::map<std::uint32_t, std::size_t> faces;
  std::set<std::uint32_t> border;
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (!mesh.has_face(h / 3)) continue;
    neighbours[mesh.from(h)].insert(mesh.to(h));
    neighbours[mesh.to(h)].insert(mesh.from(h));
    ++faces[mesh.from(h)];
    if (mesh.twins[h] == kNone) border.insert({mesh.from(h), mesh.to(h)});
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    ASSERT_EQ(mesh.has_vertex(v), neighbours.contains(v)) << v;
    if (!mesh.has_vertex(v)) continue;
    ASSERT_EQ(mesh.from(mesh.outgoing(v)), v);
    ASSERT_EQ(mesh.on_border(v), border.contains(v)) << v;
    std::size_t visited = 0;
    mesh.for_each_outgoing(v, [&](std::uint32_t h) {
      ++visited;
      ASSERT_EQ(mesh.from(h), v);
    });
    ASSERT_EQ(visited, faces[v]);
    std::set<std::uint32_t> ring;
    mesh.for_each_neighbour(v, [&](std::uint32_t w) {
      ASSERT_TRUE(ring.insert(w).second);
      ASSERT_TRUE(mesh.has_edge(v, w) && mesh.has_edge(w, v));
    });
    ASSERT_EQ(ring, neighbours[v]);
  }
}

Vec3d middle(const HalfedgeMesh& mesh, std::uint32_t f) {
  const Triangle& t = mesh.triangles[f];
  return (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
}

TEST(HalfedgeMesh, AnyChangesLeaveItSoundAndTheTopologyAsItWas) {
  for (const auto& [name, shape] : remesh_shapes()) {
    SCOPED_TRACE(name);
    HalfedgeMesh mesh(shape, 10);
    expect_sound(mesh);
    std::uint64_t counter = 0;
    const auto random = [&](std::size_t n) { return static_cast<std::uint32_t>(mix_bits(++counter) % n); };
    int done[4] = {};
    for (int i = 0; i < 4000; ++i) {
      const std::uint32_t h = random(mesh.twins.size());
      if (!mesh.has_face(h / 3)) continue;
      const std::uint32_t kind = random(8);
      if (kind == 0) {
        const Vec3d at = middle(mesh, h / 3);
        mesh.split_face(h / 3, mesh.add_vertex(at));
        ++done[0];
      } else if (kind == 1) {
        const std::uint32_t v = mesh.add_vertex(0.5 * (mesh.positions[mesh.from(h)] + mesh.positions[mesh.to(h)]));
        const std::uint32_t end = mesh.to(h), rest = mesh.split_edge(h, v);
        EXPECT_EQ(mesh.to(h), v);
        EXPECT_EQ(mesh.from(rest), v);
        EXPECT_EQ(mesh.to(rest), end);
        ++done[1];
      } else if (kind < 5 && mesh.may_flip(h)) {
        const std::uint32_t c = mesh.apex(h), d = mesh.apex(mesh.twins[h]);
        mesh.flip(h);
        EXPECT_EQ(mesh.from(h), d);
        EXPECT_EQ(mesh.to(h), c);
        ++done[2];
      } else if (kind >= 5 && mesh.may_collapse(h)) {
        mesh.collapse(h);
        ++done[3];
      }
      if (i % 500 == 0) expect_sound(mesh);
    }
    for (const int count : done) EXPECT_GT(count, 50);
    expect_sound(mesh);
    HalfedgeMesh left = mesh;
    const std::vector<std::uint32_t> kept = left.compact();
    ASSERT_EQ(kept.size(), left.vertex_count());
    for (std::size_t v = 0; v < kept.size(); ++v) EXPECT_EQ(left.positions[v], mesh.positions[kept[v]]);
    expect_same_topology(left, shape);
  }
}

TEST(HalfedgeMesh, CollapsesAsFarAsTheTopologyGoes) {
  const struct {
    PolygonSoup soup;
    std::size_t least;  // vertices that it takes at least
  } cases[] = {{icosphere(2), 4}, {torus(12, 8), 7}, {disc(5, 9), 3}, {open_cylinder(4, 9), 6}};
  for (const auto& [soup, least] : cases) {
    const TriangleMesh shape = make_mesh(soup);
    HalfedgeMesh mesh(shape, 0);
    for (bool any = true; any;) {
      any = false;
      for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
        if (!mesh.has_face(h / 3) || !mesh.may_collapse(h)) continue;
        mesh.collapse(h);
        any = true;
      }
    }
    expect_sound(mesh);
    const TriangleMesh left = compacted(mesh);
    expect_same_topology(left, shape);
    EXPECT_GE(left.vertex_count(), least);
    EXPECT_LE(left.vertex_count(), least + 4);
  }
}

TEST(HalfedgeMesh, RefusesWhatWouldJoinTwoSheets) {
  // Nothing of a tetrahedron can go or be turned: every two of its vertices are joined.
  const HalfedgeMesh four(make_mesh(tetrahedron()), 0);
  for (std::uint32_t h = 0; h < four.twins.size(); ++h) {
    EXPECT_FALSE(four.may_collapse(h));
    EXPECT_FALSE(four.may_flip(h));
  }
  const HalfedgeMesh one(make_mesh(single_triangle()), 0);
  for (std::uint32_t h = 0; h < 3; ++h) {
    EXPECT_FALSE(one.may_collapse(h));
    EXPECT_FALSE(one.may_flip(h));
  }
}

TEST(HalfedgeMesh, FeaturesStayLines) {
  // The edges of a box, through whatever else is done to it.
  const TriangleMesh box = make_mesh(perforated_slab(1, 6));
  HalfedgeMesh mesh(box, 500);
  const auto is_sharp = [](const TriangleMesh& of, std::uint32_t h) {
    const auto normal = [&](std::uint32_t f) {
      const Triangle& t = of.triangles[f];
      const Vec3d& a = of.positions[t[0]];
      return Vec3d((of.positions[t[1]] - a).cross(of.positions[t[2]] - a).normalized());
    };
    return normal(h / 3).dot(normal(of.twins[h] / 3)) < 0.5;
  };
  for (std::uint32_t h = 0; h < box.twins.size(); ++h) {
    if (is_sharp(box, h)) mesh.mark_feature(h);
  }
  insert_points(mesh, random_places(box, 500));
  std::uint64_t random = 1;
  for (int i = 0; i < 20'000; ++i) {
    const auto h = static_cast<std::uint32_t>(mix_bits(random++) % mesh.twins.size());
    if (!mesh.has_face(h / 3)) continue;
    if (i % 2 == 0 && mesh.may_flip(h)) {
      EXPECT_FALSE(mesh.is_feature(h));
      mesh.flip(h);
    }
    // Eight corners stay, as a remesher has them stay.
    if (i % 2 == 1 && mesh.from(h) < box.vertex_count() && mesh.may_collapse(h)) mesh.collapse(h);
  }
  mesh.compact();
  expect_same_topology(mesh, box);
  double length = 0;
  std::vector<int> ends(mesh.vertex_count(), 0);
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    EXPECT_EQ(mesh.is_feature(h), mesh.is_feature(mesh.twins[h]));
    if (!mesh.is_feature(h)) continue;
    ++ends[mesh.from(h)];
    length += 0.5 * (mesh.positions[mesh.to(h)] - mesh.positions[mesh.from(h)]).norm();
  }
  EXPECT_NEAR(length, 4 * (1 + 6 + 1), 1e-9) << "all twelve edges, straight";
  EXPECT_EQ(std::count(ends.begin(), ends.end(), 3), 8);
  EXPECT_EQ(std::count_if(ends.begin(), ends.end(), [](int count) { return count != 0 && count != 2 && count != 3; }), 0);
}

}  // namespace
}  // namespace curvecast
