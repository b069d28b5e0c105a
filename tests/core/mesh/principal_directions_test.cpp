#include "core/mesh/principal_directions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/mesh/curvature.h"
#include "tests/support/analytic_directions.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

void expect_directions(const PolygonSoup& soup, const AnalyticDirection& truth, double tolerance) {
  const TriangleMesh mesh = make_mesh(soup);
  const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
  std::size_t checked = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3f& direction = geometry[v].direction_max;
    EXPECT_NEAR(direction.norm(), 1, 1e-5);
    EXPECT_NEAR(direction.dot(geometry[v].normal), 0, 1e-5);
    const std::optional<Vec3d> wanted = truth(mesh.positions[v]);
    if (!wanted) continue;
    ++checked;
    EXPECT_LT(axis_angle(direction.cast<double>(), *wanted), tolerance) << "vertex " << v;
  }
  EXPECT_GT(checked, mesh.vertex_count() / 4);
}

TEST(PrincipalDirections, GoAroundACylinder) { expect_directions(open_cylinder(20, 60), around_the_axis, 0.02); }

TEST(PrincipalDirections, GoAroundTheTubeOfATorus) { expect_directions(torus(80, 40), around_the_tube, 0.05); }

TEST(PrincipalDirections, FollowAnEllipsoid) { expect_directions(ellipsoid(4), on_the_ellipsoid, 0.12); }

TEST(PrincipalDirections, FollowASaddle) { expect_directions(saddle(40), on_the_saddle, 0.02); }

TEST(PrincipalDirections, AreUnitTangentsOnAnyMesh) {
  const AnalyticDirection any = [](const Vec3d&) { return Vec3d(Vec3d::Zero()); };
  for (const PolygonSoup& soup : {single_triangle(), cube(), mobius_strip(5), icosphere(2), jittered(sphere(20, 30), 0.2)}) {
    expect_directions(soup, any, 10);
  }
}

TEST(FaceNormal, PointsOutwards) {
  const TriangleMesh mesh = make_mesh(icosphere(2));
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const Vec3f normal = face_normal(mesh, f);
    EXPECT_NEAR(normal.norm(), 1, 1e-6);
    EXPECT_GT(normal.cast<double>().dot(mesh.positions[mesh.triangles[f][0]]), 0.9);
  }
}

}  // namespace
}  // namespace curvecast
