#include "core/remesh/fit.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>

#include "core/measure/hausdorff.h"
#include "core/mesh/vertex_fans.h"
#include "core/remesh/remesh.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TriangleMesh remeshed(const TriangleMesh& surface, std::size_t n, bool fit) {
  const absl::StatusOr<Remeshed> made = remesh(surface, random_places(surface, n), {.fit = fit});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? made->mesh : TriangleMesh{};
}

TEST(Fit, LiesNearerToARoundSurface) {
  for (const TriangleMesh& surface : {make_mesh(icosphere(6)), make_mesh(torus(200, 100))}) {
    const HausdorffDistance before = hausdorff_distance(surface, remeshed(surface, 1'000, false));
    const HausdorffDistance after = hausdorff_distance(surface, remeshed(surface, 1'000, true));
    EXPECT_LT(after.forward.rms, 0.5 * before.forward.rms);
    EXPECT_LT(after.backward.rms, 0.5 * before.backward.rms);
    EXPECT_LT(after.max(), before.max());
  }
}

TEST(Fit, LeavesAPlaneAsItIs) {
  const TriangleMesh plane = make_mesh(square(20));
  const TriangleMesh before = remeshed(plane, 500, false), after = remeshed(plane, 500, true);
  ASSERT_EQ(after.vertex_count(), before.vertex_count());
  for (std::size_t v = 0; v < before.vertex_count(); ++v) EXPECT_LT((after.positions[v] - before.positions[v]).norm(), 1e-9);
}

TEST(Fit, FindsSharpEdges) {
  // Triangles between points beside an edge cut it off; fitted, their neighbours go onto them.
  const TriangleMesh box = make_mesh(perforated_slab(1, 2));
  const HausdorffDistance before = hausdorff_distance(box, remeshed(box, 2'000, false));
  const HausdorffDistance after = hausdorff_distance(box, remeshed(box, 2'000, true));
  EXPECT_LT(after.forward.rms, 0.6 * before.forward.rms);
}

TEST(Fit, KeepsTopologyAndBordersAndTurnsNothingOver) {
  for (const auto& [name, surface] : remesh_shapes()) {
    SCOPED_TRACE(name);
    const TriangleMesh before = remeshed(surface, 2'000, false), after = remeshed(surface, 2'000, true);
    EXPECT_EQ(after.triangles, before.triangles);
    const VertexFans fans(before);
    for (std::size_t v = 0; v < before.vertex_count(); ++v) {
      if (fans.on_border(v)) {
        EXPECT_EQ(after.positions[v], before.positions[v]);
      }
    }
    for (const Triangle& t : before.triangles) {
      const auto normal = [&](const std::vector<Vec3d>& at) { return Vec3d((at[t[1]] - at[t[0]]).cross(at[t[2]] - at[t[0]])); };
      EXPECT_GT(normal(before.positions).dot(normal(after.positions)), 0);
    }
  }
}

TEST(Fit, IsTheSameOnAnyNumberOfThreads) {
  const TriangleMesh surface = make_mesh(jittered(torus(80, 50), 0.01));
  const auto on_threads = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return remeshed(surface, 3'000, true); });
  };
  const TriangleMesh one = on_threads(1), two = on_threads(2);
  EXPECT_EQ(one.positions, two.positions);
}

TEST(Fit, ScalesAndMovesWithTheSurface) {
  const TriangleMesh surface = make_mesh(torus(60, 40));
  const absl::StatusOr<Remeshed> made = remesh(surface, random_places(surface, 1'000));
  ASSERT_TRUE(made.ok()) << made.status();
  const auto fitted = [&](double scale, const Vec3d& by) {
    const auto moved = [&](TriangleMesh mesh) {
      for (Vec3d& p : mesh.positions) p = scale * p + by;
      return mesh;
    };
    const TriangleMesh there = moved(surface);
    HalfedgeMesh mesh(moved(made->mesh), 0);
    const SurfaceWalk walk(there);
    std::vector<WalkPlace> places;
    for (const FacePlace& p : made->places) places.push_back(walk.place(p.face, double{p.weight_1}, double{p.weight_2}));
    fit(mesh, walk, places);
    for (Vec3d& p : mesh.positions) p = (p - by) / scale;
    return mesh.positions;
  };
  const std::vector<Vec3d> here = fitted(1, Vec3d::Zero());
  for (const double scale : {0x1p10, 0x1p-40}) EXPECT_EQ(fitted(scale, Vec3d::Zero()), here);
  // Places on edges of the surface may fall to either face.
  const std::vector<Vec3d> there = fitted(1, {4, 0, -2});
  double sum = 0;
  for (std::size_t v = 0; v < here.size(); ++v) sum += (here[v] - there[v]).norm();
  EXPECT_LT(sum / static_cast<double>(here.size()), 1e-3);
}

TEST(Fit, StopsWhenCancelled) {
  const TriangleMesh surface = make_mesh(icosphere(4));
  HalfedgeMesh mesh(remeshed(surface, 500, false), 0);
  const std::vector<Vec3d> before = mesh.positions;
  const SurfaceWalk walk(surface);
  std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  fit(mesh, walk, std::vector<WalkPlace>(mesh.vertex_count(), walk.place(0, 0, 0)), context);
  EXPECT_EQ(mesh.positions, before);
}

}  // namespace
}  // namespace curvecast
