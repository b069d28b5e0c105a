#include "core/mesh/carry_attributes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/mesh/repair.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using ::testing::IsEmpty;

Vec2f uv_at(const Vec3d& p) { return Vec2f(static_cast<float>(p.x() + 3 * p.z()), static_cast<float>(p.y() - p.z())); }
Vec3f normal_at(const Vec3d& p) { return p.normalized().cast<float>(); }
Rgba8 colour_at(const Vec3d& p) {
  const auto byte = [](double x) { return static_cast<std::uint8_t>(std::lround(100 + 50 * x)); };
  return {byte(p.x()), byte(p.y()), byte(p.z()), 200};
}

/// Attributes that tell what they were attached to.
PolygonSoup with_attributes(PolygonSoup soup) {
  MeshAttributes& at = soup.attributes;
  at.scalars.push_back({"height", {}});
  for (const Vec3d& p : soup.positions) {
    at.colours.push_back(colour_at(p));
    at.normals.push_back(normal_at(p));
    at.scalars[0].values.push_back(static_cast<float>(p.z()));
  }
  for (const std::uint32_t index : soup.indices) at.uv.push_back(uv_at(soup.positions[index]));
  at.materials.resize(soup.polygon_count());
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    at.material_of_face.push_back(static_cast<std::uint32_t>(p));
    at.face_colours.push_back({static_cast<std::uint8_t>(p), 0, 0, 255});
  }
  return soup;
}

void expect_in_place(const PolygonSoup& soup, const RepairedMesh& result) {
  const MeshAttributes& at = result.attributes;
  const TriangleMesh& mesh = result.mesh;
  ASSERT_EQ(at.colours.size(), mesh.vertex_count());
  ASSERT_EQ(at.normals.size(), mesh.vertex_count());
  ASSERT_EQ(at.scalars.size(), 1u);
  ASSERT_EQ(at.scalars[0].values.size(), mesh.vertex_count());
  ASSERT_EQ(at.uv.size(), 3 * mesh.face_count());
  ASSERT_EQ(at.material_of_face.size(), mesh.face_count());
  ASSERT_EQ(at.face_colours.size(), mesh.face_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_EQ(at.colours[v], colour_at(mesh.positions[v]));
    EXPECT_LT((at.normals[v] - normal_at(mesh.positions[v])).norm(), 1e-6F);
    EXPECT_EQ(at.scalars[0].values[v], static_cast<float>(mesh.positions[v].z()));
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(at.uv[3 * f + i], uv_at(mesh.positions[mesh.triangles[f][i]])) << f;
    // The face lies on the polygon that its material counts.
    const std::uint32_t p = at.material_of_face[f];
    EXPECT_EQ(at.face_colours[f].r, static_cast<std::uint8_t>(p));
    for (const std::uint32_t v : mesh.triangles[f]) {
      bool found = false;
      for (std::uint32_t i = soup.polygon_begin[p]; i < soup.polygon_begin[p + 1]; ++i) {
        found = found || soup.positions[soup.indices[i]] == mesh.positions[v];
      }
      EXPECT_TRUE(found) << f;
    }
  }
  EXPECT_EQ(at.materials.size(), soup.polygon_count());
}

TEST(CarryAttributes, FollowEveryRepair) {
  using namespace curvecast::testing;
  PolygonSoup flipped = sphere(7, 9);
  for (std::size_t p = 0; p < flipped.polygon_count(); p += 3) std::swap(flipped.indices[3 * p + 1], flipped.indices[3 * p + 2]);
  PolygonSoup doubled = sphere(6, 8);
  for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 0u, 5u, 9u, 10u, 11u}) {  // a duplicate, a degenerate face, a duplicate
    doubled.indices.push_back(doubled.indices[corner]);
  }
  for (int i = 0; i < 3; ++i) doubled.polygon_begin.push_back(doubled.polygon_begin.back() + 3);
  PolygonSoup spare = translated(cube(), {1, 2, 3});
  spare.positions.insert(spare.positions.begin() + 3, Vec3d(9, 9, 9));
  for (std::uint32_t& index : spare.indices) index += index >= 3;
  const PolygonSoup bow_tie = testing::soup_of({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {0, 1, 2}, {1, 0, 2}}, {{0, 1, 2}, {0, 3, 4}});
  const PolygonSoup hexagon =
      testing::soup_of({{1, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {1, 2, 0}, {2, 1, 0.0}}, {{0, 1, 2, 3, 4, 5}});
  PolygonSoup own = unshared(torus(6, 7));
  own.shares_vertices = true;
  for (const PolygonSoup& shape : {flipped, doubled, spare, bow_tie, hexagon, own, unshared(sphere(5, 6)), mobius_strip(9)}) {
    const PolygonSoup soup = with_attributes(shape);
    const absl::StatusOr<RepairedMesh> result = repair(soup);
    ASSERT_TRUE(result.ok()) << result.status();
    expect_in_place(soup, *result);
  }
}

TEST(CarryAttributes, TextureSeamsKeepTheirCorners) {
  // Two triangles that share an edge in space but not in the texture.
  PolygonSoup soup = testing::soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}});
  soup.attributes.uv = {{0, 0}, {1, 0}, {0, 1}, {5, 5}, {6, 6}, {7, 7}};
  soup.attributes.normals = {{0, 0, 1}, {1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
  const absl::StatusOr<RepairedMesh> result = repair(soup);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->mesh.vertex_count(), 4u);
  EXPECT_EQ(result->report.welded_vertices, 2u);
  EXPECT_EQ(result->attributes.uv, soup.attributes.uv);
  // The mean normal where two vertices became one.
  EXPECT_LT((result->attributes.normals[result->mesh.triangles[0][1]] - Vec3f(1, 1, 0).normalized()).norm(), 1e-6F);
}

TEST(CarryAttributes, HardColoursOfSoupsBecomeFaceColours) {
  PolygonSoup soup = testing::unshared(testing::tetrahedron());
  for (std::size_t v = 0; v < soup.positions.size(); ++v)
    soup.attributes.colours.push_back({static_cast<std::uint8_t>(v / 3), 0, 0, 255});
  absl::StatusOr<RepairedMesh> result = repair(soup);
  ASSERT_TRUE(result.ok());
  EXPECT_THAT(result->attributes.colours, IsEmpty());
  ASSERT_EQ(result->attributes.face_colours.size(), 4u);
  for (std::size_t f = 0; f < 4; ++f) EXPECT_EQ(result->attributes.face_colours[f].r, f);
  soup.attributes.colours[0].g = 1;  // no single colour for this face
  result = repair(soup);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->attributes.colours.size(), 4u);
  EXPECT_THAT(result->attributes.face_colours, IsEmpty());
}

}  // namespace
}  // namespace curvecast
