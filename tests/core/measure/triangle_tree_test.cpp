#include "core/measure/triangle_tree.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "core/base/random.h"
#include "core/measure/random_surface_points.h"
#include "core/mesh/triangle_distance.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

double distance_to(const TriangleMesh& mesh, std::size_t f, const Vec3d& p) {
  const Triangle& t = mesh.triangles[f];
  return triangle_distance(p, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
}

std::vector<Vec3d> around(const TriangleMesh& mesh, std::size_t n, double amount) {
  std::vector<Vec3d> points = random_surface_points(mesh, n, 1).positions;
  for (std::size_t i = 0; i < n; ++i) {
    const auto unit = [&](std::size_t k) { return random_unit(2, 3 * i + k) - 0.5; };
    points[i] += amount * Vec3d(unit(0), unit(1), unit(2));
  }
  return points;
}

TEST(TriangleTree, FindsWhatBruteForceFinds) {
  using namespace testing;
  for (const PolygonSoup& soup : {single_triangle(), cube(), sphere(20, 30), perforated_slab(5, 5), mobius_strip(40),
                                  merged(torus(12, 8), translated(icosphere(3), {5, 0, 0}))}) {
    const TriangleMesh mesh = make_mesh(soup);
    const TriangleTree tree(mesh);
    for (const double amount : {0.0, 0.1, 20.0}) {
      const std::vector<Vec3d> points = around(mesh, 200, amount);
      std::vector<NearestFace> found(points.size());
      tree.nearest(points, found);
      for (std::size_t i = 0; i < points.size(); ++i) {
        double least = 1e300;
        for (std::size_t f = 0; f < mesh.face_count(); ++f) least = std::min(least, distance_to(mesh, f, points[i]));
        EXPECT_NEAR(found[i].distance, least, 1e-14);
        EXPECT_EQ(found[i].distance, distance_to(mesh, found[i].face, points[i]));
        EXPECT_NEAR(tree.nearest(points[i]).distance, least, 1e-14);
      }
    }
  }
}

TEST(TriangleTree, FindsTheFacesThatPointsWereMadeOn) {
  const TriangleMesh mesh = testing::make_mesh(testing::sphere(30, 40));
  const SurfacePoints points = random_surface_points(mesh, 5000, 7);
  std::vector<NearestFace> found(points.positions.size());
  TriangleTree(mesh).nearest(points.positions, found);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].face, points.faces[i]);
    EXPECT_LT(found[i].distance, 1e-14);
  }
}

TEST(TriangleTree, AnswersTheSameForAnyNumberOfThreads) {
  // On edges and corners there is a choice.
  const TriangleMesh mesh = testing::make_mesh(testing::cube());
  std::vector<Vec3d> points;
  for (int i = 0; i < 2000; ++i) points.emplace_back(i % 3 / 2.0, i / 3 % 3 / 2.0, i / 9 % 3 / 2.0);
  std::vector<NearestFace> one(points.size()), four(points.size());
  const auto run = [&](int threads, std::vector<NearestFace>& found) {
    tbb::task_arena(threads).execute([&] { TriangleTree(mesh).nearest(points, found); });
  };
  run(1, one);
  run(4, four);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].face, four[i].face);
}

}  // namespace
}  // namespace curvecast
