#include "core/mesh/crease_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
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

/// Two squares, folded along the y axis.
TriangleMesh fold(double degrees) {
  const double angle = degrees * kPi / 180, x = std::cos(angle), z = -std::sin(angle);
  return make_mesh(soup_of({{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {x, 0, z}, {x, 1, z}}, {{0, 1, 2, 3}, {1, 4, 5, 2}}));
}

TEST(CreaseNormals, BeginAtTheAngle) {
  EXPECT_TRUE(crease_normals(fold(39)).normals.empty());
  EXPECT_EQ(crease_normals(fold(41)).normals.size(), 4u);
  for (const double crease : {1.0, 20.0, 40.0, 90.0, 170.0, 179.0}) {
    for (const double degrees : {0.0, 0.9, 1.1, 19.0, 21.0, 39.0, 41.0, 89.0, 91.0, 169.0, 171.0, 178.9}) {
      SCOPED_TRACE(::testing::Message() << "a fold of " << degrees << ", creases from " << crease);
      const TriangleMesh mesh = fold(degrees);
      const CreaseNormals creases = crease_normals(mesh, crease);
      EXPECT_EQ(creases.normals.size(), degrees > crease ? 4u : 0u);
      for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
        EXPECT_LT((normal.normal - face_normal(mesh, f)).norm(), 1e-6f);
      });
    }
  }
}

TEST(CreaseNormals, AreOfAllEdgesAt0DegreesAndOfNoneAt180) {
  for (const PolygonSoup& soup : {square(4), cube(), icosphere(3), open_cylinder(4, 12), torus(24, 16)}) {
    const TriangleMesh mesh = make_mesh(soup);
    EXPECT_TRUE(crease_normals(mesh, 180).normals.empty());
    const CreaseNormals creases = crease_normals(mesh, 0);
    std::size_t corners = 0;
    for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
      ++corners;
      EXPECT_LT((normal.normal - face_normal(mesh, f)).norm(), 1e-6f);
    });
    std::vector<int> faces_around(mesh.vertex_count());
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t v : triangle) ++faces_around[v];
    }
    const auto alone = static_cast<std::size_t>(std::count(faces_around.begin(), faces_around.end(), 1));
    EXPECT_EQ(corners, 3 * mesh.face_count() - alone) << "the corners of a sheet have one face, and its normal";
    EXPECT_EQ(creases.normals.size(), corners);
  }
  EXPECT_TRUE(crease_normals(fold(179.999), 180).normals.empty());
}

/// Closed, along the z axis.
PolygonSoup prism(std::uint32_t sides) {
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> polygons(2);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * kPi * i / sides;
    positions.emplace_back(std::cos(angle), std::sin(angle), 0);
    positions.emplace_back(std::cos(angle), std::sin(angle), 1);
    const std::uint32_t next = (i + 1) % sides;
    polygons.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
    polygons[0].push_back(2 * (sides - 1 - i));
    polygons[1].push_back(2 * i + 1);
  }
  return soup_of(positions, polygons);
}

/// A closed prism: smooth around, creased along its lids.
TEST(CreaseNormals, KeepSmoothSidesSmooth) {
  for (const std::uint32_t sides : {12u, 24u}) {  // edges of 30 and of 15 degrees
    SCOPED_TRACE(sides);
    const TriangleMesh mesh = make_mesh(prism(sides));
    const CreaseNormals creases = crease_normals(mesh);
    EXPECT_EQ(creases.normals.size(), 4 * sides);  // a lid's and the side's at every vertex
    for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
      const Vec3d& p = mesh.positions[normal.vertex];
      const bool is_lid = std::abs(face_normal(mesh, f).z()) > 0.5f;
      const Vec3f expected = is_lid ? Vec3f(0, 0, p.z() > 0.5 ? 1 : -1) : Vec3f(p.cast<float>().x(), p.cast<float>().y(), 0);
      // The sides' triangles have other angles there.
      EXPECT_GT(normal.normal.dot(expected), is_lid ? 0.9999f : 0.99f);
    });
  }
}

TEST(CreaseNormals, DivideTheSidesWhereTheAngleIsSmaller) {
  const TriangleMesh mesh = make_mesh(prism(12));
  const CreaseNormals creases = crease_normals(mesh, 20);
  EXPECT_EQ(creases.normals.size(), 6 * 12u);  // a lid's and both sides'
  for_each_corner(mesh, creases, [&](std::uint32_t f, const CreaseNormal& normal) {
    EXPECT_LT((normal.normal - face_normal(mesh, f)).norm(), 1e-6f);
  });
}

/// Of nine sides: whether an edge has 40.000001 degrees or 39.999999 is an accident of rounding.
TEST(CreaseNormals, EdgesOfTheVeryAngleAreAllSmooth) {
  PolygonSoup soup = prism(9);
  for (Vec3d& p : soup.positions) p = p.cast<float>().cast<double>();
  const TriangleMesh mesh = make_mesh(soup);
  EXPECT_EQ(crease_normals(mesh, 40).normals.size(), 4 * 9u);
  EXPECT_EQ(crease_normals(mesh, 39.9).normals.size(), 6 * 9u);
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
