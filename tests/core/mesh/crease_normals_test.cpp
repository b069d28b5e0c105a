#include "core/mesh/crease_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/mesh/curvature.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr double kPi = std::numbers::pi;

/// Every face's corner of which a normal is said, with what it is said to be.
template <typename Visit>
void for_each_corner(const TriangleMesh& mesh, const CreaseNormals& creases, Visit&& visit) {
  for (const CreaseFace& face : creases.faces) {
    for (int i = 0; i < 3; ++i) {
      if (face.normals[i] == kNone) continue;
      ASSERT_LT(face.normals[i], creases.normals.size());
      const CreaseNormal& normal = creases.normals[face.normals[i]];
      EXPECT_EQ(normal.vertex, mesh.triangles[face.face][i]);
      EXPECT_NEAR(normal.normal.norm(), 1, 1e-6);
      visit(face.face, normal);
    }
  }
}

TEST(CreaseNormals, OfACubeAreThoseOfItsFaces) {
  const TriangleMesh mesh = make_mesh(cube());
  const CreaseNormals creases = crease_normals(mesh);
  EXPECT_EQ(creases.normals.size(), 24u);  // three at each corner
  ASSERT_EQ(creases.faces.size(), mesh.face_count());
  std::size_t corners = 0;
  for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
    ++corners;
    EXPECT_LT((normal.normal - face_normal(mesh, f)).norm(), 1e-6f);
  });
  EXPECT_EQ(corners, 3 * mesh.face_count());
  for (std::size_t i = 1; i < creases.normals.size(); ++i) EXPECT_LE(creases.normals[i - 1].vertex, creases.normals[i].vertex);
  for (std::size_t i = 1; i < creases.faces.size(); ++i) EXPECT_LT(creases.faces[i - 1].face, creases.faces[i].face);
}

TEST(CreaseNormals, BeginAt45Degrees) {
  for (const double degrees : {0.0, 30.0, 44.0, 46.0, 90.0, 170.0}) {
    SCOPED_TRACE(degrees);
    const double angle = degrees * kPi / 180;  // two squares, folded along the y axis
    const double x = std::cos(angle), z = -std::sin(angle);
    const TriangleMesh mesh =
        make_mesh(soup_of({{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {x, 0, z}, {x, 1, z}}, {{0, 1, 2, 3}, {1, 4, 5, 2}}));
    const CreaseNormals creases = crease_normals(mesh);
    EXPECT_EQ(creases.normals.size(), degrees > 45 ? 4u : 0u);
    for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
      EXPECT_LT((normal.normal - face_normal(mesh, f)).norm(), 1e-6f);
    });
  }
}

/// A closed prism: smooth around, creased along its lids.
TEST(CreaseNormals, KeepSmoothSidesSmooth) {
  constexpr std::uint32_t kSides = 24;
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> polygons(2);
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * kPi * i / kSides;
    positions.emplace_back(std::cos(angle), std::sin(angle), 0);
    positions.emplace_back(std::cos(angle), std::sin(angle), 1);
    const std::uint32_t next = (i + 1) % kSides;
    polygons.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
    polygons[0].push_back(2 * (kSides - 1 - i));
    polygons[1].push_back(2 * i + 1);
  }
  const TriangleMesh mesh = make_mesh(soup_of(positions, polygons));
  const CreaseNormals creases = crease_normals(mesh);
  EXPECT_EQ(creases.normals.size(), 4 * kSides);  // a lid's and the side's at every vertex
  for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
    const Vec3d& p = mesh.positions[normal.vertex];
    const bool is_lid = std::abs(face_normal(mesh, f).z()) > 0.5f;
    const Vec3f expected = is_lid ? Vec3f(0, 0, p.z() > 0.5 ? 1 : -1) : Vec3f(p.cast<float>().x(), p.cast<float>().y(), 0);
    EXPECT_LT((normal.normal - expected).norm(), 0.01f);
  });
}

/// A cone's tip, sharper along one ray than along the rest: from the tip to the border there is one crease alone.
TEST(CreaseNormals, AreDividedOnlyBetweenTwoCreases) {
  constexpr std::uint32_t kSides = 32;
  std::vector<Vec3d> positions = {{0, 0, 0}};
  std::vector<std::vector<std::uint32_t>> polygons;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * kPi * i / kSides;
    const double from_ray = std::abs(angle > kPi ? angle - 2 * kPi : angle) / kPi;  // 0 on the ray y = 0, x > 0
    positions.emplace_back(std::cos(angle), std::sin(angle), 1.5 * std::pow(1 - from_ray, 2) - 1.5);
    polygons.push_back({0, 1 + i, 1 + (i + 1) % kSides});
  }
  const TriangleMesh mesh = make_mesh(soup_of(positions, polygons));
  const CreaseNormals creases = crease_normals(mesh);
  ASSERT_EQ(creases.normals.size(), 2u);  // at the ray's outer end, where the border and the crease divide; none at the tip
  EXPECT_EQ(mesh.positions[creases.normals[0].vertex], Vec3d(1, 0, 0));
  EXPECT_EQ(mesh.positions[creases.normals[1].vertex], Vec3d(1, 0, 0));
}

TEST(CreaseNormals, SmoothMeshesHaveNone) {
  const CreaseNormals creases = crease_normals(make_mesh(icosphere(3)));
  EXPECT_TRUE(creases.normals.empty());
  EXPECT_TRUE(creases.faces.empty());
}

}  // namespace
}  // namespace curvecast
