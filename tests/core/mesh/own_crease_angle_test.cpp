#include "core/mesh/own_crease_angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "core/mesh/crease_normals.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// A shape with normals of its corners.
struct Shaded {
  PolygonSoup soup;
  std::vector<Vec3f> normals;
  std::vector<std::uint32_t> normal_of_corner;

  std::optional<double> angle(bool is_quantised = false) const {
    return own_crease_angle(soup, {normals, normal_of_corner, {}, is_quantised});
  }
};

/// `normal`: of a place on a polygon that faces somewhere.
Shaded shaded(PolygonSoup soup, const std::function<Vec3d(const Vec3d& place, const Vec3d& facing)>& normal) {
  Shaded out{std::move(soup), {}, {}};
  for (std::size_t p = 0; p < out.soup.polygon_count(); ++p) {
    const std::uint32_t begin = out.soup.polygon_begin[p];
    const auto at = [&](std::uint32_t i) { return out.soup.positions[out.soup.indices[begin + i]]; };
    const Vec3d facing = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (std::uint32_t i = begin; i < out.soup.polygon_begin[p + 1]; ++i) {
      out.normal_of_corner.push_back(static_cast<std::uint32_t>(out.normals.size()));
      out.normals.push_back(normal(out.soup.positions[out.soup.indices[i]], facing).normalized().cast<float>());
    }
  }
  return out;
}

/// A prism, upright.
PolygonSoup drum(std::uint32_t sides) {
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> polygons(2);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    positions.insert(positions.end(), {{std::cos(angle), std::sin(angle), 0}, {std::cos(angle), std::sin(angle), 1}});
    const std::uint32_t j = (i + 1) % sides;
    polygons.push_back({2 * i, 2 * j, 2 * j + 1, 2 * i + 1});
    polygons[0].insert(polygons[0].begin(), 2 * i);
    polygons[1].push_back(2 * i + 1);
  }
  return soup_of(positions, polygons);
}

const auto as_facing = [](const Vec3d& /*place*/, const Vec3d& facing) { return facing; };
const auto from_centre = [](const Vec3d& place, const Vec3d& /*facing*/) { return place; };
/// Of a drum: smooth around, flat at both ends.
const auto as_drum = [](const Vec3d& place, const Vec3d& facing) {
  return std::abs(facing.z()) > 0.5 ? facing : Vec3d(place.x(), place.y(), 0);
};

TEST(OwnCreaseAngle, LiesBetweenSmoothEdgesAndSplitOnes) {
  EXPECT_EQ(shaded(drum(16), as_drum).angle(), kCreaseDegrees) << "between 22.5 and 90";
  EXPECT_NEAR(*shaded(drum(6), as_drum).angle(), 75, 0.01) << "between 60 and 90";
  EXPECT_NEAR(*shaded(drum(9), as_drum).angle(), 65, 0.01) << "40 is no clear answer where edges turn by 40";
}

TEST(OwnCreaseAngle, IsTheMostOrTheLeastWhereNothingOrEverythingIsSplit) {
  EXPECT_EQ(shaded(icosphere(0), from_centre).angle(), 180) << "edges of 42 degrees, and smooth";
  EXPECT_EQ(shaded(icosphere(0), as_facing).angle(), 0);
  EXPECT_EQ(shaded(icosphere(3), from_centre).angle(), 180);
  EXPECT_EQ(shaded(icosphere(3), as_facing).angle(), std::nullopt) << "programs write normals of faces, whatever the mesh";
}

TEST(OwnCreaseAngle, IsTheOneThatIsWrongForFewestEdges) {
  // 45 degrees around, of which two edges are split, and 90 at the ends, of which one is not.
  Shaded one = shaded(drum(8), as_drum);
  for (std::uint32_t i = 8 + 8; i < 8 + 8 + 4; ++i) one.normals[i] = Vec3f(0.5f, 0.2f, 0.84f);  // one side leans
  const std::optional<double> angle = one.angle();
  ASSERT_TRUE(angle.has_value());
  EXPECT_GT(*angle, 45);
  EXPECT_LT(*angle, 90);
}

TEST(OwnCreaseAngle, IsSilentWhereNothingTells) {
  Shaded silent = shaded(drum(16), as_drum);
  EXPECT_EQ(own_crease_angle(silent.soup, {}), std::nullopt);
  EXPECT_EQ(own_crease_angle(silent.soup, {silent.normals, {}, {}}), std::nullopt);
  EXPECT_EQ(shaded(square(4), as_facing).angle(), std::nullopt) << "flat";
  for (Vec3f& normal : silent.normals) normal = Vec3f::Zero();
  EXPECT_EQ(silent.angle(), std::nullopt);
  silent.normal_of_corner.assign(silent.normal_of_corner.size(), 1u << 30);
  EXPECT_EQ(silent.angle(), std::nullopt);
}

TEST(OwnCreaseAngle, IsTheSameOfFacesWithVerticesOfTheirOwnAndOfManyFaces) {
  Shaded apart = shaded(unshared(drum(16)), as_drum);
  EXPECT_EQ(apart.angle(), kCreaseDegrees);
  Shaded fine = shaded(jittered(sphere(300, 500), 0.01), from_centre);  // 300,000 triangles: some of their edges are looked at
  EXPECT_EQ(fine.angle(), 180);
}

TEST(OwnCreaseAngle, IsSilentWhereFacesLieOnOneAnother) {
  for (const std::size_t times : {2u, 3u, 50'000u}) {
    const PolygonSoup soup = soup_of(tetrahedron().positions, std::vector<std::vector<std::uint32_t>>(times, {0, 1, 2}));
    const std::vector<std::uint32_t> groups(times, 1);
    EXPECT_EQ(own_crease_angle(soup, {{}, {}, groups}), std::nullopt) << times;
  }
}

/// Rounds places to a lattice and normals to 8 bits.
Shaded quantised(Shaded shape, double step) {
  for (Vec3d& p : shape.soup.positions) p = (p / step).array().round() * step;
  for (Vec3f& n : shape.normals) n = (n * 127).array().round() / 127;
  return shape;
}

TEST(OwnCreaseAngle, OfQuantisedNormalsIsThatOfTheOthers) {
  for (const PolygonSoup& ball : {icosphere(3), icosphere(4)}) {  // turns of 8 and 4 degrees
    const Shaded flat = shaded(ball, as_facing);
    EXPECT_EQ(quantised(flat, 1e-4).angle(true), flat.angle());
    const Shaded round = shaded(ball, [](const Vec3d& place, const Vec3d&) { return place; });
    EXPECT_EQ(quantised(round, 1e-4).angle(true), round.angle());
  }
  const Shaded fine = shaded(icosphere(6), as_facing);
  EXPECT_EQ(quantised(fine, 1e-4).angle(true), std::nullopt) << "turns of a degree are lost in the rounding";
  const Shaded box = shaded(drum(12), as_facing);
  EXPECT_EQ(quantised(box, 1e-4).angle(true), box.angle());
}

}  // namespace
}  // namespace curvecast
