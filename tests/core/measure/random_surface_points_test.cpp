#include "core/measure/random_surface_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/mesh/triangle_distance.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

TEST(RandomSurfacePoints, LieOnTheirFacesAndFillThemByArea) {
  const TriangleMesh mesh = testing::make_mesh(testing::torus(12, 8));
  const std::size_t n = 100'000;
  const SurfacePoints points = random_surface_points(mesh, n, 3);
  std::vector<double> count(mesh.face_count());
  std::vector<Vec3d> sum(mesh.face_count(), Vec3d::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    const Triangle& t = mesh.triangles[points.faces[i]];
    ASSERT_LT(triangle_distance(points.positions[i], mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]), 1e-12);
    ++count[points.faces[i]];
    sum[points.faces[i]] += points.positions[i];
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const double expected = static_cast<double>(n) * triangle_area(mesh, f) / surface_area(mesh);
    EXPECT_NEAR(count[f], expected, 5 * std::sqrt(expected));
    const Triangle& t = mesh.triangles[f];
    const Vec3d middle = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    EXPECT_LT((sum[f] / count[f] - middle).norm(), 2 * std::sqrt(triangle_area(mesh, f) / count[f]));
  }
}

TEST(RandomSurfacePoints, AreThoseOfTheirSeedHoweverMany) {
  const TriangleMesh mesh = testing::make_mesh(testing::tetrahedron());
  const SurfacePoints few = random_surface_points(mesh, 10, 1), many = random_surface_points(mesh, 20, 1);
  EXPECT_TRUE(std::equal(few.positions.begin(), few.positions.end(), many.positions.begin()));
  EXPECT_NE(random_surface_points(mesh, 10, 2).positions, few.positions);
}

}  // namespace
}  // namespace curvecast
