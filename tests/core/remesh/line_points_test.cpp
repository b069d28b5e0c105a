#include "core/remesh/line_points.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<Vec3d> positions_of(const TriangleMesh& mesh, std::size_t n) { return random_surface_points(mesh, n, 3).positions; }

LinePoints on_borders(const TriangleMesh& mesh, const std::vector<Vec3d>& positions) {
  return place_on_lines(mesh, surface_lines(mesh, {}), positions);
}

TEST(LinePoints, AreAsFarApartAsThePointsBesideThem) {
  const TriangleMesh disc = make_mesh(testing::disc(20, 60));
  for (const std::size_t n : {300u, 3'000u, 30'000u}) {
    const LinePoints found = on_borders(disc, positions_of(disc, n));
    const double spacing = std::sqrt(2 / std::numbers::sqrt3 * surface_area(disc) / static_cast<double>(n));
    double length = 0;
    for (std::uint32_t h = 0; h < disc.twins.size(); ++h) {
      if (disc.twins[h] == kNone) length += (disc.positions[disc.to(h)] - disc.positions[disc.from(h)]).norm();
    }
    EXPECT_NEAR(static_cast<double>(found.places.size()), length / spacing, 0.15 * length / spacing);
    EXPECT_TRUE(found.corners.empty()) << "a circle has none";
    EXPECT_EQ(found.stand_ins.size(), found.places.size());
    const std::set<std::uint32_t> different(found.stand_ins.begin(), found.stand_ins.end());
    EXPECT_EQ(different.size(), found.stand_ins.size());
    EXPECT_LT(*different.rbegin(), n);
  }
}

TEST(LinePoints, AreDenserWherePointsAre) {
  const TriangleMesh strip = make_mesh(square(10));
  // Sixteen times as many in the right half.
  std::vector<Vec3d> positions;
  for (const Vec3d& p : positions_of(strip, 2'000)) positions.emplace_back(0.5 * p.x(), p.y(), 0);
  for (const Vec3d& p : positions_of(strip, 32'000)) positions.emplace_back(0.5 + 0.5 * p.x(), p.y(), 0);
  const LinePoints found = on_borders(strip, positions);
  double left = 0, right = 0;
  for (const LinePlace& place : found.places) (strip.positions[strip.from(place.halfedge)].x() < 0.5 ? left : right) += 1;
  EXPECT_NEAR(right / left, 4, 1);
}

TEST(LinePoints, CornersStay) {
  for (const int cells : {1, 12}) {
    const TriangleMesh mesh = make_mesh(square(cells));
    for (const std::size_t n : {20u, 500u, 20'000u}) {
      const LinePoints found = on_borders(mesh, positions_of(mesh, n));
      ASSERT_EQ(found.corners.size(), 4u);
      for (const std::uint32_t v : found.corners) {
        const Vec3d& p = mesh.positions[v];
        EXPECT_TRUE((p.x() == 0 || p.x() == 1) && (p.y() == 0 || p.y() == 1));
      }
      EXPECT_EQ(found.stand_ins.size(), found.places.size() + 4);
      const double spacing = std::sqrt(2 / std::numbers::sqrt3 / static_cast<double>(n));
      EXPECT_NEAR(static_cast<double>(found.places.size() + 4), 4 / spacing, std::max(3.0, 0.15 * 4 / spacing));
    }
  }
}

TEST(LinePoints, JaggedBordersHaveNoMoreCornersThanPoints) {
  // Teeth far smaller than the distance of points.
  std::vector<Vec3d> positions = {{0, 0, 0}};
  std::vector<std::vector<std::uint32_t>> triangles;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const double angle = 2 * std::numbers::pi * i / 400, radius = i % 2 == 0 ? 1 : 0.98;
    positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    triangles.push_back({0, i + 1, (i + 1) % 400 + 1});
  }
  const TriangleMesh saw = make_mesh(soup_of(positions, triangles));
  const LinePoints found = on_borders(saw, positions_of(saw, 200));
  EXPECT_LT(found.corners.size() + found.places.size(), 80u);
}

TEST(LinePoints, AreThreeAtLeast) {
  const TriangleMesh cylinder = make_mesh(open_cylinder(10, 20));
  const LinePoints found = on_borders(cylinder, positions_of(cylinder, 10));
  EXPECT_GE(found.places.size(), 6u);
  const LinePoints few = on_borders(cylinder, positions_of(cylinder, 4));
  EXPECT_GE(few.places.size(), 6u);
  EXPECT_EQ(few.stand_ins.size(), 4u) << "more there are not";
  EXPECT_TRUE(on_borders(make_mesh(icosphere(2)), {}).places.empty());
}

TEST(LinePoints, OnFeaturesAreAsFarApartAsThePointsBesideThem) {
  const TriangleMesh box = make_mesh(perforated_slab(1, 2));  // 1 x 2 x 1
  for (const std::size_t n : {500u, 5'000u, 50'000u}) {
    const LinePoints found = place_on_lines(box, surface_lines(box, sharp_edges(box, 45)), positions_of(box, n));
    const double spacing = std::sqrt(2 / std::numbers::sqrt3 * surface_area(box) / static_cast<double>(n));
    EXPECT_EQ(found.corners.size(), 8u);
    EXPECT_NEAR(static_cast<double>(found.places.size()), 16 / spacing - 12, 0.15 * 16 / spacing);
    EXPECT_EQ(found.stand_ins.size(), found.places.size() + 8);
  }
}

TEST(LinePoints, ShortLooseFeaturesAreLeftOut) {
  const TriangleMesh plane = make_mesh(square(50));
  SurfaceLine scratch;
  for (std::uint32_t h = 0; h < plane.twins.size() && scratch.halfedges.empty(); ++h) {
    if (plane.twins[h] != kNone && plane.positions[plane.from(h)].norm() > 0.5) scratch.halfedges = {h};
  }
  scratch.has_loose_end = true;
  const std::vector<SurfaceLine> lines = {scratch};
  EXPECT_EQ(place_on_lines(plane, lines, positions_of(plane, 400)).used, std::vector<bool>{false});
  EXPECT_EQ(place_on_lines(plane, lines, positions_of(plane, 40'000)).used, std::vector<bool>{true});
}

}  // namespace
}  // namespace curvecast
