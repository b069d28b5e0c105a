#include "core/flatten/vertex_hierarchy.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <set>
#include <utility>

#include "core/flatten/cut_to_disc.h"
#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using testing::make_mesh;

std::vector<TriangleMesh> meshes() {
  using namespace testing;
  std::vector<TriangleMesh> all;
  for (const PolygonSoup& soup : {sphere(20, 30), jittered(torus(24, 12), 0.02), perforated_slab(7, 7), open_cylinder(12, 16),
                                  disc(8, 24), tetrahedron(), single_triangle(), mobius_strip(20)}) {
    all.push_back(make_mesh(soup));
  }
  all.push_back(*cut_to_disc(make_mesh(torus(24, 12))));
  all.push_back(*cut_to_disc(make_mesh(icosphere(4))));
  return all;
}

std::vector<std::uint32_t> neighbours(const VertexHierarchy& hierarchy, std::uint32_t v) {
  std::vector<std::uint32_t> found;
  hierarchy.for_each_neighbour(v, [&](std::uint32_t x) { found.push_back(x); });
  return found;
}

/// The same cycle may start anywhere; a border vertex's neighbours come in one order only.
std::vector<std::uint32_t> canonical(std::vector<std::uint32_t> ring, bool border) {
  if (!border) std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  return ring;
}

std::vector<std::vector<std::uint32_t>> rings(const TriangleMesh& mesh, const VertexHierarchy& hierarchy) {
  std::vector<std::vector<std::uint32_t>> all;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    all.push_back(canonical(neighbours(hierarchy, v), hierarchy.on_border(v)));
  }
  return all;
}

/// Takes all levels back: they are independent, and in the end all is as it was.
void expect_to_come_back(const TriangleMesh& mesh, VertexHierarchy& hierarchy,
                         const std::vector<std::vector<std::uint32_t>>& before) {
  std::size_t there = hierarchy.base().size();
  while (hierarchy.level_count() > 0) {
    const std::vector<std::uint32_t> level = hierarchy.level(hierarchy.level_count() - 1);
    hierarchy.restore_level();
    there += level.size();
    const std::set<std::uint32_t> members(level.begin(), level.end());
    EXPECT_EQ(members.size(), level.size());
    for (const std::uint32_t v : level) {
      for (const std::uint32_t x : neighbours(hierarchy, v)) EXPECT_FALSE(members.contains(x));
    }
  }
  EXPECT_EQ(there, mesh.vertex_count());
  EXPECT_EQ(rings(mesh, hierarchy), before);
}

TEST(VertexHierarchy, LevelsAreIndependentAndComeBackAsTheyWere) {
  for (const TriangleMesh& mesh : meshes()) {
    VertexHierarchy hierarchy(mesh, {});
    const std::vector<std::vector<std::uint32_t>> before = rings(mesh, hierarchy);
    hierarchy.coarsen(4);
    expect_to_come_back(mesh, hierarchy, before);
  }
}

TEST(VertexHierarchy, BlocksOfLargeMeshesDoNotDependOnThreads) {
  const TriangleMesh mesh = make_mesh(testing::jittered(testing::torus(500, 300), 0.001));
  ASSERT_GE(mesh.vertex_count(), 8u * 16384u);
  std::vector<std::vector<VertexHierarchy::Level>> levels;
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    VertexHierarchy hierarchy(mesh, {});
    const std::vector<std::vector<std::uint32_t>> before = rings(mesh, hierarchy);
    arena.execute([&] { hierarchy.coarsen(500); });
    EXPECT_LE(hierarchy.base().size(), 500u);
    EXPECT_EQ(analyse_topology(hierarchy.base_mesh()).genus, 1u);
    if (threads > 1) {
      levels.push_back(std::move(hierarchy).take_levels());
      continue;
    }
    VertexHierarchy again = hierarchy;
    levels.push_back(std::move(again).take_levels());
    expect_to_come_back(mesh, hierarchy, before);
  }
  for (const std::vector<VertexHierarchy::Level>& other : levels) {
    ASSERT_EQ(other.size(), levels[0].size());
    for (std::size_t l = 0; l < other.size(); ++l) EXPECT_EQ(other[l].halfedges, levels[0][l].halfedges);
  }
}

TEST(VertexHierarchy, LevelsOfWholeMeshesServeWhatIsCutFromThem) {
  for (const TriangleMesh& mesh : {make_mesh(testing::icosphere(5)), make_mesh(testing::jittered(testing::torus(80, 40), 0.01)),
                                   make_mesh(testing::disc(30, 40)), make_mesh(testing::perforated_slab(9, 9))}) {
    VertexHierarchy whole(mesh, {});
    whole.coarsen(100);
    const std::vector<VertexHierarchy::Level> levels = std::move(whole).take_levels();
    const DiscMesh disc = *cut_to_disc(mesh);
    const std::vector<std::uint32_t> pinned = {disc.border[0], disc.border[disc.border.size() / 2]};
    VertexHierarchy hierarchy(disc, pinned);
    const std::vector<std::vector<std::uint32_t>> before = rings(disc, hierarchy);
    hierarchy.coarsen_like(levels);
    EXPECT_LT(hierarchy.base().size(), 100 + disc.border.size());
    hierarchy.coarsen(40);
    for (const std::uint32_t v : pinned) EXPECT_TRUE(std::ranges::binary_search(hierarchy.base(), v));
    const Topology coarse = analyse_topology(hierarchy.base_mesh());
    EXPECT_EQ(coarse.components, 1u);
    EXPECT_EQ(coarse.genus, 0u);
    EXPECT_EQ(coarse.boundary_loops, 1u);
    expect_to_come_back(disc, hierarchy, before);
  }
}

TEST(VertexHierarchy, CoarseMeshesKeepTheTopology) {
  for (const TriangleMesh& mesh : meshes()) {
    VertexHierarchy hierarchy(mesh, {});
    hierarchy.coarsen(10);
    const TriangleMesh coarse = hierarchy.base_mesh();
    EXPECT_EQ(coarse.vertex_count(), hierarchy.base().size());
    const Topology fine = analyse_topology(mesh), left = analyse_topology(coarse);
    EXPECT_EQ(left.components, fine.components);
    EXPECT_EQ(left.genus, fine.genus);
    EXPECT_EQ(left.boundary_loops, fine.boundary_loops);
    for (std::uint32_t h = 0; h < coarse.twins.size(); ++h) {
      const std::uint32_t t = coarse.twins[h];
      if (t == kNone) continue;
      EXPECT_EQ(coarse.twins[t], h);
      EXPECT_EQ(coarse.from(t), coarse.to(h));
      EXPECT_EQ(coarse.to(t), coarse.from(h));
    }
    for (const Triangle& t : coarse.triangles) EXPECT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
  }
}

TEST(VertexHierarchy, GoesFarAndKeepsThePinned) {
  const DiscMesh disc = *cut_to_disc(make_mesh(testing::icosphere(5)));
  const std::vector<std::uint32_t> pinned = {disc.border[0], disc.border[disc.border.size() / 2], 7, 700};
  VertexHierarchy hierarchy(disc, pinned);
  hierarchy.coarsen(40);
  EXPECT_LE(hierarchy.base().size(), 40u);
  for (const std::uint32_t v : pinned) {
    EXPECT_TRUE(std::binary_search(hierarchy.base().begin(), hierarchy.base().end(), v));
  }
}

TEST(VertexHierarchy, NoInnerEdgeEverJoinsTwoBorderVertices) {
  const DiscMesh disc = *cut_to_disc(make_mesh(testing::jittered(testing::torus(30, 16), 0.02)));
  VertexHierarchy hierarchy(disc, {});
  hierarchy.coarsen(4);
  for (const std::uint32_t v : hierarchy.base()) {
    if (!hierarchy.on_border(v)) continue;
    const std::vector<std::uint32_t> ring = neighbours(hierarchy, v);
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) EXPECT_FALSE(hierarchy.on_border(ring[i]));
  }
}

TEST(VertexHierarchy, HasNoLevelsWhenCancelled) {
  const TriangleMesh mesh = make_mesh(testing::icosphere(3));
  VertexHierarchy hierarchy(mesh, {});
  const std::atomic<bool> cancel = true;
  hierarchy.coarsen(4, {.cancel = &cancel});
  EXPECT_EQ(hierarchy.level_count(), 0u);
  EXPECT_EQ(hierarchy.base().size(), mesh.vertex_count());
}

TEST(VertexHierarchy, FlatVerticesGoFirst) {
  // A plate with one spike: the spike outlives the plate around it.
  PolygonSoup soup = testing::disc(30, 40);
  soup.positions[600].z() = 1;
  const TriangleMesh mesh = make_mesh(soup);
  VertexHierarchy hierarchy(mesh, {});
  hierarchy.coarsen(120);
  const TriangleMesh coarse = hierarchy.base_mesh();
  EXPECT_TRUE(std::any_of(coarse.positions.begin(), coarse.positions.end(), [](const Vec3d& p) { return p.z() == 1; }));
}

}  // namespace
}  // namespace curvecast
