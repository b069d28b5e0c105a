#include "core/remesh/remove_vertices.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

#include "core/remesh/insert_points.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<std::uint32_t> first_vertices(std::size_t count) {
  std::vector<std::uint32_t> vertices(count);
  std::iota(vertices.begin(), vertices.end(), 0u);
  return vertices;
}

TEST(RemoveVertices, LeavesAllOthersInPlace) {
  const TriangleMesh shape = make_mesh(jittered(icosphere(4), 0.01));
  HalfedgeMesh mesh(shape, 500);
  insert_points(mesh, random_places(shape, 500));
  const std::vector<Vec3d> before = mesh.positions;
  VertexRemover remover(mesh);
  EXPECT_TRUE(remover.remove(first_vertices(shape.vertex_count())).empty());
  HalfedgeMesh left = mesh;
  const std::vector<std::uint32_t> kept = left.compact();
  ASSERT_EQ(left.vertex_count(), 500u);
  for (std::size_t v = 0; v < kept.size(); ++v) EXPECT_EQ(left.positions[v], before[shape.vertex_count() + v]);
  expect_same_topology(left, shape);
  // No triangle looks inwards.
  for (const Triangle& t : left.triangles) {
    const Vec3d &a = left.positions[t[0]], &b = left.positions[t[1]], &c = left.positions[t[2]];
    EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0);
  }
}

TEST(RemoveVertices, TellsWhatIsLeft) {
  const TriangleMesh shape = make_mesh(torus(20, 12));
  HalfedgeMesh mesh(shape, 3);
  insert_points(mesh, random_places(shape, 3));
  VertexRemover remover(mesh);
  const std::vector<std::uint32_t> left = remover.remove(first_vertices(shape.vertex_count()));
  EXPECT_GE(left.size(), 4u) << "a torus takes seven";
  for (const std::uint32_t v : left) EXPECT_TRUE(mesh.has_vertex(v));
  const TriangleMesh seven = compacted(mesh);
  EXPECT_EQ(seven.vertex_count(), 3 + left.size());
  expect_same_topology(seven, shape);
}

TEST(RemoveVertices, NoMoreThanAskedForAndNoneOnceCancelled) {
  const TriangleMesh shape = make_mesh(icosphere(3));
  HalfedgeMesh mesh(shape, 0);
  VertexRemover remover(mesh);
  EXPECT_EQ(remover.remove(first_vertices(100), {}, 10).size(), 90u);
  const std::atomic<bool> cancel = true;
  EXPECT_EQ(remover.remove(first_vertices(shape.vertex_count()), {.on_progress = {}, .cancel = &cancel}).size(),
            shape.vertex_count());
}

}  // namespace
}  // namespace curvecast
