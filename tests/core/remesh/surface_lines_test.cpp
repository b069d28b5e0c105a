#include "core/remesh/surface_lines.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

double length_of(const TriangleMesh& mesh, const SurfaceLine& line) {
  double length = 0;
  for (const std::uint32_t h : line.halfedges) length += (mesh.positions[mesh.to(h)] - mesh.positions[mesh.from(h)]).norm();
  return length;
}

void expect_connected(const TriangleMesh& mesh, const std::vector<SurfaceLine>& lines) {
  std::vector<int> seen(mesh.twins.size(), 0);
  for (const SurfaceLine& line : lines) {
    ASSERT_FALSE(line.halfedges.empty());
    for (std::size_t i = 0; i < line.halfedges.size(); ++i) {
      const std::uint32_t h = line.halfedges[i], twin = mesh.twins[h];
      EXPECT_EQ(++seen[h], 1);
      if (twin != kNone) {
        EXPECT_EQ(++seen[twin], 1);
      }
      EXPECT_EQ(twin == kNone, line.is_border);
      if (i > 0) {
        EXPECT_EQ(mesh.from(h), mesh.to(line.halfedges[i - 1]));
      }
    }
    if (line.is_closed) {
      EXPECT_EQ(mesh.to(line.halfedges.back()), mesh.from(line.halfedges.front()));
    }
  }
}

TEST(SurfaceLines, AreTheBordersWithoutFeatures) {
  for (const auto& [name, shape] : remesh_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<SurfaceLine> lines = surface_lines(shape, {});
    EXPECT_EQ(lines.size(), analyse_topology(shape).boundary_loops);
    expect_connected(shape, lines);
    for (const SurfaceLine& line : lines) EXPECT_TRUE(line.is_border && line.is_closed && !line.has_loose_end);
  }
}

TEST(SurfaceLines, OfABoxAreItsEdges) {
  const TriangleMesh box = make_mesh(perforated_slab(1, 4));
  const std::vector<SurfaceLine> lines = surface_lines(box, sharp_edges(box, 30));
  expect_connected(box, lines);
  ASSERT_EQ(lines.size(), 12u);
  std::vector<double> lengths;
  for (const SurfaceLine& line : lines) {
    EXPECT_FALSE(line.is_border || line.is_closed || line.has_loose_end);
    lengths.push_back(length_of(box, line));
  }
  std::sort(lengths.begin(), lengths.end());
  EXPECT_EQ(lengths, (std::vector<double>{1, 1, 1, 1, 1, 1, 1, 1, 4, 4, 4, 4}));
  EXPECT_TRUE(surface_lines(box, sharp_edges(box, 100)).empty());
}

TEST(SurfaceLines, MayBeLoops) {
  // Two cones on one rim.
  std::vector<Vec3d> positions = {{0, 0, 1}, {0, 0, -1}};
  std::vector<std::vector<std::uint32_t>> triangles;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const double angle = 2 * std::numbers::pi * i / 60;
    positions.emplace_back(std::cos(angle), std::sin(angle), 0);
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % 60;
    triangles.push_back({0, a, b});
    triangles.push_back({1, b, a});
  }
  const TriangleMesh top = make_mesh(soup_of(positions, triangles));
  const std::vector<SurfaceLine> lines = surface_lines(top, sharp_edges(top, 60));
  expect_connected(top, lines);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].is_closed);
  EXPECT_EQ(lines[0].halfedges.size(), 60u);
}

TEST(SurfaceLines, EndAtBordersAndLoose) {
  // A ridge from the middle of a sheet to its border.
  PolygonSoup sheet = square(10);
  for (Vec3d& p : sheet.positions) {
    if (std::abs(p.y() - 0.5) < 1e-9 && p.x() > 0.45) p.z() = 0.1;
  }
  const TriangleMesh surface = make_mesh(sheet);
  const std::vector<SurfaceLine> lines = surface_lines(surface, sharp_edges(surface, 80));
  expect_connected(surface, lines);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[0].is_border);
  EXPECT_FALSE(lines[1].is_closed);
  EXPECT_TRUE(lines[1].has_loose_end);
  EXPECT_NEAR(length_of(surface, lines[1]), 0.5, 0.11);
}

}  // namespace
}  // namespace curvecast
