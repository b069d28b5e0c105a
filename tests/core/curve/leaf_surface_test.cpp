#include "core/curve/leaf_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "tests/support/flat_curve.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::shared_ptr<const LeafSurface> surface_of(const PolygonSoup& soup, std::uint64_t points) {
  const std::string off = to_off(soup);
  const absl::StatusOr<Preprocessed> done = preprocess({"shape.off", off}, {.points = points});
  EXPECT_TRUE(done.ok()) << done.status();
  return leaf_surface(*done);
}

bool are_same(const SurfacePlace& a, const SurfacePlace& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

std::vector<double> even_parts(std::size_t count) {
  std::vector<double> parts(count);
  for (std::size_t i = 0; i < count; ++i) parts[i] = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
  return parts;
}

TEST(LeafSurface, PlacesLieInTheirLeafInTheCurvesOrder) {
  constexpr int kLevel = 2, kMore = 2;
  const auto surface = flat_surface(flat_curve(kLevel));
  constexpr std::size_t kCount = std::size_t{1} << 2 * kMore;
  const std::vector<double> parts = even_parts(kCount);
  for (std::size_t l = 0; l < surface->curve().size(); ++l) {
    std::vector<SurfacePlace> found(kCount), even(kCount);
    surface->find(l, parts, 1e-6, found);
    std::vector<LeafPart> at;
    for (const double part : parts) at.push_back({static_cast<std::uint32_t>(l), part});
    surface->find_even(at, even);
    for (std::size_t i = 0; i < kCount; ++i) {
      // The finer curve's cell there: both are even on a flat square.
      const HilbertCell cell = hilbert_cell(l * kCount + i, kLevel + kMore);
      const float side = 1.0f / (1 << (kLevel + kMore));
      for (const SurfacePlace& place : {found[i], even[i]}) {
        EXPECT_NEAR(place.position[0], (static_cast<float>(cell.x) + 0.5f) * side, 0.501f * side);
        EXPECT_NEAR(place.position[1], (static_cast<float>(cell.y) + 0.5f) * side, 0.501f * side);
      }
    }
  }
}

TEST(LeafSurface, APlaceDependsOnItsLeafAndPartAlone) {
  const auto surface = surface_of(merged(icosphere(3), translated(torus(12, 9), {4, 0, 0})), 500);
  std::vector<LeafPart> at;
  for (std::uint32_t l = 0; l < surface->curve().size(); ++l) {
    for (const double part : even_parts(1 + l % 5)) at.push_back({l, part});
  }
  std::vector<SurfacePlace> places(at.size());
  surface->find_even(at, places);
  std::vector<std::size_t> order(at.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  std::vector<LeafPart> shuffled;
  for (const std::size_t i : order) shuffled.push_back(at[i]);
  std::vector<SurfacePlace> again(at.size());
  surface->find_even(shuffled, again);
  for (std::size_t i = 0; i < order.size(); ++i) {
    SurfacePlace alone;
    surface->find_even({&shuffled[i], 1}, {&alone, 1});
    ASSERT_TRUE(are_same(alone, again[i])) << i;
    ASSERT_TRUE(are_same(again[i], places[order[i]])) << i;
  }
}

TEST(LeafSurface, NothingAskedForIsNothingFound) {
  const auto surface = flat_surface(flat_curve(1));
  surface->find_even({}, {});
}

TEST(LeafSurface, PlacesAreTheirFacesBarycentricCombinations) {
  const auto soup = torus(24, 16);
  const std::string off = to_off(soup);
  const absl::StatusOr<Preprocessed> done = preprocess({"shape.off", off}, {.points = 500});
  ASSERT_TRUE(done.ok()) << done.status();
  const auto surface = leaf_surface(*done);
  const TriangleMesh& mesh = done->flattened->loaded.mesh;
  const std::vector<double> parts = even_parts(7);
  for (std::size_t l = 0; l < surface->curve().size(); l += 11) {
    std::vector<SurfacePlace> places(2 * parts.size());
    surface->find(l, parts, 0.1, std::span(places).first(parts.size()));
    std::vector<LeafPart> at;
    for (const double part : parts) at.push_back({static_cast<std::uint32_t>(l), part});
    surface->find_even(at, std::span(places).subspan(parts.size()));
    for (const SurfacePlace& place : places) {
      const Triangle& t = mesh.triangles[place.face];
      const double b = place.weight_1, c = place.weight_2;
      EXPECT_GE(b, 0);
      EXPECT_GE(c, 0);
      EXPECT_LE(b + c, 1 + 1e-6);
      const Vec3d there = (1 - b - c) * mesh.positions[t[0]] + b * mesh.positions[t[1]] + c * mesh.positions[t[2]];
      const Vec3d here = surface->curve().origin + Vec3d(place.position[0], place.position[1], place.position[2]);
      EXPECT_LE((here - there).norm(), 1e-6 * surface->curve().box.diagonal());
    }
  }
}

}  // namespace
}  // namespace curvecast
