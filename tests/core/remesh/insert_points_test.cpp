#include "core/remesh/insert_points.h"

#include <gtest/gtest.h>

#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(InsertPoints, LieWhereTheyShallAndDivideTheirFaces) {
  for (const auto& [name, shape] : remesh_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<FacePlace> points = random_places(shape, 5'000);
    HalfedgeMesh mesh(shape, points.size());
    insert_points(mesh, points);
    ASSERT_EQ(mesh.vertex_count(), shape.vertex_count() + points.size());
    EXPECT_EQ(mesh.face_count(), shape.face_count() + 2 * points.size());
    EXPECT_NEAR(surface_area(mesh), surface_area(shape), 1e-9 * surface_area(shape));
    const double diagonal = bounding_box(shape).diagonal();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Triangle& t = shape.triangles[points[i].face];
      const Vec3d& a = shape.positions[t[0]];
      const Vec3d at =
          a + double{points[i].weight_1} * (shape.positions[t[1]] - a) + double{points[i].weight_2} * (shape.positions[t[2]] - a);
      ASSERT_LE((mesh.positions[shape.vertex_count() + i] - at).norm(), 1e-4 * diagonal);
    }
    expect_same_topology(compacted(mesh), shape);
  }
}

TEST(InsertPoints, OnCornersEdgesAndEachOther) {
  const TriangleMesh shape = make_mesh(cube());
  std::vector<FacePlace> points;
  for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
    for (const float u : {0.0f, 0.25f, 0.5f, 1.0f}) {
      for (const float v : {0.0f, 0.25f, 0.5f, 1.0f}) {
        if (u + v <= 1) points.insert(points.end(), 3, {f, u, v});
      }
    }
  }
  HalfedgeMesh mesh(shape, points.size());
  insert_points(mesh, points);
  expect_same_topology(compacted(mesh), shape);
  std::vector<Vec3d> positions = mesh.positions;
  const auto is_before = [](const Vec3d& a, const Vec3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(positions.begin(), positions.end(), is_before);
  EXPECT_EQ(std::adjacent_find(positions.begin(), positions.end()), positions.end()) << "two at the same place";
  EXPECT_NEAR(surface_area(mesh), surface_area(shape), 1e-9);
}

TEST(InsertPoints, ALineOfThemGoesQuickly) {
  const TriangleMesh shape = make_mesh(single_triangle());
  std::vector<FacePlace> points;
  for (int i = 1; i < 100'000; ++i)
    points.push_back({0, static_cast<float>(i) / 100'000, 0.25f * (1 - static_cast<float>(i) / 100'000)});
  HalfedgeMesh mesh(shape, points.size());
  insert_points(mesh, points);
  EXPECT_EQ(mesh.face_count(), 1 + 2 * points.size());
}

TEST(InsertPoints, OnBorders) {
  const TriangleMesh shape = make_mesh(square(1));
  std::uint32_t corner = 0;
  const HalfedgeMesh plain(shape, 0);
  while (!plain.on_border(corner)) ++corner;
  const Vec3d from = shape.positions[corner], to = shape.positions[plain.to(plain.outgoing(corner))];
  HalfedgeMesh mesh(shape, 3);
  const std::uint32_t edge = plain.outgoing(corner);
  insert_line_points(mesh, shape, std::vector<LinePlace>{{edge, 0.25}, {edge, 0.5}, {edge, 0.875}});
  ASSERT_EQ(mesh.vertex_count(), 7u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(mesh.on_border(4 + i));
    EXPECT_NEAR((mesh.positions[4 + i] - (from + (i == 0 ? 0.25 : i == 1 ? 0.5 : 0.875) * (to - from))).norm(), 0, 1e-12);
  }
  EXPECT_EQ(mesh.to(mesh.outgoing(corner)), 4u);
  EXPECT_EQ(mesh.to(mesh.outgoing(4)), 5u);
  expect_same_topology(compacted(mesh), shape);
}

TEST(InsertPoints, OnFeatures) {
  const TriangleMesh shape = make_mesh(icosphere(2));
  const std::uint32_t edge = 100;
  HalfedgeMesh mesh(shape, 52);
  mesh.mark_feature(edge);
  insert_points(mesh, random_places(shape, 50));
  insert_line_points(mesh, shape, std::vector<LinePlace>{{edge, 0.5}, {edge, 0.75}});
  expect_same_topology(compacted(mesh), shape);
  // The line runs through both of them.
  std::vector<std::uint32_t> line = {shape.from(edge)};
  for (std::size_t before = 0; before < line.size() && line.size() < 10; ++before) {
    mesh.for_each_outgoing(line[before], [&](std::uint32_t h) {
      if (mesh.is_feature(h) && (before == 0 || mesh.to(h) != line[before - 1])) line.push_back(mesh.to(h));
    });
  }
  const auto first = static_cast<std::uint32_t>(shape.vertex_count() + 50);
  EXPECT_EQ(line, (std::vector<std::uint32_t>{shape.from(edge), first, first + 1, shape.to(edge)}));
}

}  // namespace
}  // namespace curvecast
