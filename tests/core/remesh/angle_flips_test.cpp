#include "core/remesh/angle_flips.h"

#include <gtest/gtest.h>

#include "core/remesh/insert_points.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// The angle at the corner across h, in radians.
double angle_across(const HalfedgeMesh& mesh, std::uint32_t h) {
  const Vec3d& at = mesh.positions[mesh.apex(h)];
  const Vec3d p = mesh.positions[mesh.from(h)] - at, q = mesh.positions[mesh.to(h)] - at;
  return std::atan2(p.cross(q).norm(), p.dot(q));
}

TEST(AngleFlips, AreDelaunayOnAPlane) {
  // No circle of three corners has a fourth point in it: the angles across all edges say so.
  const TriangleMesh square = make_mesh(testing::square(3));
  const std::vector<FacePlace> points = random_places(square, 3'000);
  HalfedgeMesh mesh(square, points.size());
  insert_points(mesh, points);
  AngleFlips flips(mesh);
  flips.add_all();
  flips.run();
  expect_same_topology(compacted(mesh), square);
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] == kNone) continue;
    ASSERT_LE(angle_across(mesh, h) + angle_across(mesh, mesh.twins[h]), std::numbers::pi * (1 + 1e-6));
  }
  double area = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vec3d normal = (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    ASSERT_GT(normal.z(), 0) << "folded over";
    area += 0.5 * normal.z();
  }
  EXPECT_NEAR(area, 1, 1e-9);
}

TEST(AngleFlips, KeepTheTopologyOfAnySurface) {
  for (const auto& [name, shape] : remesh_shapes()) {
    HalfedgeMesh mesh(shape, 2'000);
    insert_points(mesh, random_places(shape, 2'000));
    AngleFlips flips(mesh);
    flips.add_all();
    flips.run();
    expect_same_topology(compacted(mesh), shape);
  }
}

TEST(AngleFlips, LookAtWhatWasAddedAlone) {
  // A thin rhombus whose long diagonal is its edge.
  TriangleMesh rhombus = make_mesh(soup_of({{-3, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {1, 0, 3}}));
  HalfedgeMesh mesh(rhombus, 0);
  AngleFlips flips(mesh);
  flips.run();
  EXPECT_FALSE(mesh.has_edge(2, 3));
  flips.add_around(0);
  flips.run();
  EXPECT_TRUE(mesh.has_edge(2, 3));
  EXPECT_FALSE(mesh.has_edge(0, 1));
}

}  // namespace
}  // namespace curvecast
