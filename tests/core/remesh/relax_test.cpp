#include "core/remesh/relax.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <numeric>

#include "core/measure/triangle_tree.h"
#include "core/remesh/insert_points.h"
#include "core/remesh/remove_vertices.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// A mesh of random points, relaxed.
HalfedgeMesh relaxed(const TriangleMesh& shape, std::size_t points, int rounds) {
  const std::vector<FacePlace> at = random_places(shape, points);
  HalfedgeMesh mesh(shape, points);
  insert_points(mesh, at);
  std::vector<std::uint32_t> own(shape.vertex_count());
  std::iota(own.begin(), own.end(), 0u);
  const SurfaceWalk walk(shape);
  std::vector<WalkPlace> places(mesh.vertex_count());
  for (std::uint32_t v = 0; v < shape.vertex_count(); ++v) {
    const std::uint32_t h = walk.fans().outgoing(v);
    places[v] = walk.place(h / 3, h % 3 == 1, h % 3 == 2);
  }
  for (std::size_t i = 0; i < points; ++i) {
    places[shape.vertex_count() + i] = walk.place(at[i].face, double{at[i].weight_1}, double{at[i].weight_2});
  }
  VertexRemover(mesh).remove(own);
  relax(mesh, walk, places, rounds);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.has_vertex(v)) {
      EXPECT_NEAR((mesh.positions[v] - places[v].position).norm(), 0, 1e-4);
    }
  }
  return mesh;
}

TEST(Relax, MakesTrianglesRegularOnTheSurface) {
  const TriangleMesh ball = make_mesh(icosphere(5));
  const std::vector<double> before = least_angles(relaxed(ball, 4'000, 0));
  const HalfedgeMesh mesh = relaxed(ball, 4'000, 10);
  const std::vector<double> after = least_angles(mesh);
  EXPECT_LT(before[before.size() / 100], 5);
  EXPECT_GT(after[after.size() / 100], 25);
  EXPECT_GT(after[after.size() / 2], 45);
  const TriangleTree tree(ball);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.has_vertex(v)) {
      ASSERT_LT(tree.nearest(mesh.positions[v]).distance, 1e-12);
    }
  }
  for (const Triangle& t : mesh.triangles) {
    if (t[0] == kNone) continue;
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    ASSERT_GT((b - a).cross(c - a).dot(a + b + c), 0) << "turned over";
  }
}

TEST(Relax, KeepsTopologyAndBorders) {
  for (const auto& [name, shape] : remesh_shapes()) {
    SCOPED_TRACE(name);
    const HalfedgeMesh before = relaxed(shape, 2'000, 0), after = relaxed(shape, 2'000, 5);
    expect_same_topology(compacted(after), shape);
    for (std::uint32_t v = 0; v < after.vertex_count(); ++v) {
      ASSERT_EQ(after.has_vertex(v), before.has_vertex(v));
      if (after.has_vertex(v) && after.on_border(v)) {
        EXPECT_EQ(after.positions[v], before.positions[v]);
      }
    }
  }
}

TEST(Relax, IsTheSameOnAnyNumberOfThreads) {
  const TriangleMesh shape = make_mesh(torus(30, 20));
  const HalfedgeMesh many = relaxed(shape, 3'000, 4);
  tbb::task_arena alone(1);
  const HalfedgeMesh one = alone.execute([&] { return relaxed(shape, 3'000, 4); });
  EXPECT_EQ(one.triangles, many.triangles);
  EXPECT_EQ(one.positions, many.positions);
}

}  // namespace
}  // namespace curvecast
