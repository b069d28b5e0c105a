#include "core/measure/triangle_angles.h"

#include <gtest/gtest.h>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(TriangleAngles, OfKnownShapes) {
  const LeastAngles regular = least_angles(make_mesh(tetrahedron()));
  EXPECT_NEAR(regular.least, 60, 1e-9);
  EXPECT_NEAR(regular.median, 60, 1e-9);
  EXPECT_EQ(regular.below_20, 0);
  const LeastAngles halves = least_angles(make_mesh(square(5)));
  EXPECT_NEAR(halves.least, 45, 1e-9);
  EXPECT_NEAR(halves.percentile_1, 45, 1e-9);
  const LeastAngles ball = least_angles(make_mesh(icosphere(0)));
  EXPECT_NEAR(ball.median, 60, 1e-9);
}

TEST(TriangleAngles, CountsThinTriangles) {
  // Three thin ones of a hundred: angles of atan(1 / 10).
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.1, 0}};
  mesh.triangles.assign(97, {0, 1, 2});
  mesh.triangles.insert(mesh.triangles.end(), 3, {0, 1, 3});
  const LeastAngles found = least_angles(mesh);
  EXPECT_NEAR(found.median, 45, 1e-9);
  EXPECT_NEAR(found.percentile_1, 5.7105931, 1e-6);
  EXPECT_NEAR(found.least, 5.7105931, 1e-6);
  EXPECT_DOUBLE_EQ(found.below_20, 0.03);
}

TEST(TriangleAngles, OfTrianglesWithoutAnAreaAndOfNone) {
  TriangleMesh mesh;
  EXPECT_EQ(least_angles(mesh).median, 0);
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(least_angles(mesh).least, 0);
  EXPECT_EQ(least_angles(mesh).below_20, 1);
}

}  // namespace
}  // namespace curvecast
