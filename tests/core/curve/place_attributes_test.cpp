#include "core/curve/place_attributes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/curve/leaf_surface.h"
#include "core/pipeline/curve_surface.h"
#include "tests/support/analytic_directions.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::shared_ptr<const LeafSurface> surface_of(const PolygonSoup& soup) {
  const std::string ply = to_ply(soup);
  const absl::StatusOr<Preprocessed> done = preprocess({"shape.ply", ply}, {.points = 500});
  EXPECT_TRUE(done.ok()) << done.status();
  return leaf_surface(*done);
}

/// Calls visit(leaf, place) for some places within all leaves.
template <typename Visit>
void visit_places(const LeafSurface& surface, Visit&& visit) {
  for (std::uint32_t l = 0; l < surface.curve().size(); l += 3) {
    const std::vector<LeafPart> parts = {{l, 0.1}, {l, 0.6}};
    std::vector<SurfacePlace> places(parts.size());
    surface.find_even(parts, places);
    for (const SurfacePlace& place : places) visit(l, place);
  }
}

void expect_directions(const PolygonSoup& soup, const AnalyticDirection& most, double tolerance) {
  const auto surface = surface_of(soup);
  std::size_t checked = 0, all = 0;
  visit_places(*surface, [&](std::uint32_t l, const SurfacePlace& place) {
    const Vec3f normal(place.normal[0], place.normal[1], place.normal[2]);
    const SurfaceData* const data = surface->data_of(l, place.face);
    ASSERT_NE(data, nullptr);
    const Vec3f least = direction_min_at(*data, place.face, {place.weight_1, place.weight_2}, normal);
    ++all;
    ASSERT_NEAR(least.norm(), 1, 1e-5);
    ASSERT_NEAR(least.dot(normal), 0, 1e-5);
    ASSERT_EQ(least, direction_min_at(*data, place.face, {place.weight_1, place.weight_2}, normal));
    const std::optional<Vec3d> wanted =
        most(surface->curve().origin + Vec3d(place.position[0], place.position[1], place.position[2]));
    if (!wanted) return;
    ++checked;
    EXPECT_LT(axis_angle(normal.cross(least).cast<double>(), *wanted), tolerance) << "in leaf " << l;
  });
  EXPECT_GT(checked, all / 4);
}

TEST(PlaceAttributes, DirectionsFollowKnownSurfaces) {
  for (const auto& [soup, direction, tolerance] : known_surfaces()) expect_directions(soup, direction, tolerance);
}

TEST(PlaceAttributes, DirectionsAreTangentsWhereNoneIsSpecial) {
  expect_directions(
      square(8), [](const Vec3d&) { return std::optional(Vec3d(0, 0, 0)); }, 4);
  expect_directions(
      icosphere(3), [](const Vec3d&) { return std::optional(Vec3d(0, 0, 0)); }, 4);
}

TEST(PlaceAttributes, NormalsAreThoseOfThePoints) {
  for (const PolygonSoup& soup : {torus(24, 16), cube(), open_cylinder(4, 12)}) {
    const auto surface = surface_of(soup);
    visit_places(*surface, [&](std::uint32_t l, const SurfacePlace& place) {
      const Vec3f normal = normal_at(*surface->data_of(l, place.face), place.face, {place.weight_1, place.weight_2});
      ASSERT_NEAR(normal.norm(), 1, 1e-6);
      ASSERT_LT((normal - Vec3f(place.normal[0], place.normal[1], place.normal[2])).norm(), 1e-5) << "in leaf " << l;
    });
  }
}

TEST(PlaceAttributes, NormalsEndAtCreases) {
  const auto surface = surface_of(cube());
  visit_places(*surface, [&](std::uint32_t l, const SurfacePlace& place) {
    const SurfaceData& data = *surface->data_of(l, place.face);
    const Vec3d flat = area_vector(data.mesh, place.face).normalized();
    ASSERT_LT((normal_at(data, place.face, {0.01f, 0.01f}).cast<double>() - flat).norm(), 1e-6);
  });
}

TEST(PlaceAttributes, ScalarsAreLinearOverFaces) {
  PolygonSoup soup = torus(24, 16);
  const auto linear = [](const Vec3d& p) { return 2 * p.x() - p.y() + 3 * p.z() + 1; };
  ScalarAttribute heat{"heat", {}}, steady{"steady", {}};
  for (const Vec3d& p : soup.positions) {
    heat.values.push_back(static_cast<float>(linear(p)));
    steady.values.push_back(7);
  }
  soup.attributes.scalars = {heat, steady};
  const auto surface = surface_of(soup);
  visit_places(*surface, [&](std::uint32_t l, const SurfacePlace& place) {
    const SurfaceData& data = *surface->data_of(l, place.face);
    const Vec3d p = surface->curve().origin + Vec3d(place.position[0], place.position[1], place.position[2]);
    ASSERT_NEAR(scalar_at(data, 0, place.face, {place.weight_1, place.weight_2}), linear(p), 1e-5);
    ASSERT_NEAR(scalar_at(data, 1, place.face, {place.weight_1, place.weight_2}), 7, 1e-5);
  });
}

TEST(PlaceAttributes, CornersHaveWhatTheirVerticesHave) {
  PolygonSoup soup = square(1);
  soup.attributes.scalars = {{"some", {1, kNaN, 3, 4}}};
  const auto surface = surface_of(soup);
  const SurfaceData& data = *surface->data_of(0, 0);
  std::size_t numbers = 0;
  for (std::uint32_t face = 0; face < 2; ++face) {
    const Triangle& corners = data.mesh.triangles[face];
    const auto at = [&](float w1, float w2) { return scalar_at(data, 0, face, {w1, w2}); };
    const float values[] = {data.scalars[0][corners[0]], data.scalars[0][corners[1]], data.scalars[0][corners[2]]};
    const bool is_whole = std::isfinite(values[0] + values[1] + values[2]);
    EXPECT_EQ(std::isfinite(at(0.25f, 0.5f)), is_whole);
    if (!is_whole) continue;
    ++numbers;
    EXPECT_EQ(at(0, 0), values[0]);
    EXPECT_EQ(at(1, 0), values[1]);
    EXPECT_EQ(at(0, 1), values[2]);
    EXPECT_EQ(at(0.25f, 0.5f), 0.25f * values[0] + 0.25f * values[1] + 0.5f * values[2]);
  }
  EXPECT_EQ(numbers, 1u);
}

}  // namespace
}  // namespace curvecast
