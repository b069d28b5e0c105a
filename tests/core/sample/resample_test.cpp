#include "core/sample/resample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/pipeline/pipeline.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;
using ::testing::HasSubstr;

constexpr std::uint64_t kMaxPointsHere = 2000;

/// A shape with the curve on it.
struct Surface {
  TriangleMesh mesh;
  std::shared_ptr<const SurfaceCurve> curve;
};

Surface surface_of(const PolygonSoup& soup) {
  const std::string off = to_off(soup);
  absl::StatusOr<Preprocessed> done = preprocess({"shape.off", off}, {.points = kMaxPointsHere});
  EXPECT_TRUE(done.ok()) << done.status();
  return {make_mesh(soup), done.ok() ? done->curve : std::make_shared<SurfaceCurve>()};
}

const Surface& ball() {
  static const Surface surface = surface_of(icosphere(4));
  return surface;
}

PointSet points_of(const Surface& surface, const ResampleOptions& options) {
  absl::StatusOr<PointSet> points = resample(*surface.curve, options);
  EXPECT_TRUE(points.ok()) << points.status();
  return points.ok() ? *std::move(points) : PointSet{};
}

TEST(Resample, PointsHaveTheCurvesColours) {
  EXPECT_TRUE(points_of(ball(), {.points = 100}).colours.empty());
  auto curve = std::make_shared<SurfaceCurve>(*ball().curve);
  curve->colour.resize(curve->size());
  for (std::size_t l = 0; l < curve->size(); ++l) {
    curve->colour[l] = {static_cast<std::uint8_t>(l), static_cast<std::uint8_t>(l >> 8), static_cast<std::uint8_t>(l >> 16)};
  }
  const PointSet points = points_of({ball().mesh, curve}, {.points = 1000});
  ASSERT_EQ(points.colours.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(points.colours[i], curve->colour[points.vertices[i]]);
}

/// Distance from p to the triangle a, b, c: to its plane where p lies above it, else to the nearest side.
double distance_to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = (b - a).cross(c - a).normalized();
  const std::array<Vec3d, 3> corner = {a, b, c};
  bool above = true;
  double nearest = 1e300;
  for (int i = 0; i < 3; ++i) {
    const Vec3d side = corner[(i + 1) % 3] - corner[i];
    above &= side.cross(p - corner[i]).dot(normal) >= 0;
    const double along = std::clamp((p - corner[i]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - corner[i] - along * side).norm());
  }
  return above ? std::abs((p - a).dot(normal)) : nearest;
}

/// The points lie on the triangles that their curve vertices name; everything has N entries and is what it should be.
void expect_on_surface(const Surface& surface, const PointSet& points, std::size_t count, double tolerance) {
  ASSERT_EQ(points.positions.size(), count);
  ASSERT_EQ(points.normals.size(), count);
  ASSERT_EQ(points.radii.size(), count);
  ASSERT_EQ(points.vertices.size(), count);
  EXPECT_TRUE(std::is_sorted(points.vertices.begin(), points.vertices.end()));
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_LT(points.vertices[i], surface.curve->size());
    const std::uint32_t f = surface.curve->triangle[points.vertices[i]];
    ASSERT_LT(f, surface.mesh.face_count());
    const Triangle& t = surface.mesh.triangles[f];
    const auto& p = surface.mesh.positions;
    ASSERT_LT(distance_to_triangle(points.origin + points.positions[i].cast<double>(), p[t[0]], p[t[1]], p[t[2]]), tolerance);
    ASSERT_NEAR(points.normals[i].norm(), 1, 1e-4);
    ASSERT_TRUE(std::isfinite(points.radii[i]) && points.radii[i] > 0);
  }
}

TEST(Resample, PutsExactlyNPointsOnTheSurface) {
  for (const PolygonSoup& soup :
       {disc(6, 20), icosphere(3), torus(30, 14), open_cylinder(8, 24), perforated_slab(5, 3), tetrahedron(), mobius_strip(20),
        single_triangle(), merged(icosphere(2), translated(torus(12, 9), {4, 0, 0}))}) {
    const Surface surface = surface_of(soup);
    for (const std::uint64_t n : {1u, 2u, 333u, 2000u}) {
      for (const Sequence sequence : {Sequence::kJittered, Sequence::kRegular, Sequence::kVanDerCorput, Sequence::kGoldenRatio}) {
        expect_on_surface(surface, points_of(surface, {.points = n, .sequence = sequence}), n, 2e-6);
      }
    }
  }
}

TEST(Resample, FollowsTheSeed) {
  const auto bytes = [](const PointSet& p) {
    std::string all(reinterpret_cast<const char*>(p.positions.data()), p.size() * sizeof(Vec3f));
    all.append(reinterpret_cast<const char*>(p.normals.data()), p.size() * sizeof(Vec3f));
    return all.append(reinterpret_cast<const char*>(p.radii.data()), p.size() * sizeof(float));
  };
  const Density density = seen_from(Vec3d(3, 0, 0), {ViewTerm{}, CurvatureTerm{}});
  const PointSet points = points_of(ball(), {.points = 1000, .density = density, .seed = 3});
  EXPECT_EQ(bytes(points), bytes(points_of(ball(), {.points = 1000, .density = density, .seed = 3})));
  EXPECT_NE(points.vertices, points_of(ball(), {.points = 1000, .density = density, .seed = 4}).vertices);
  // The curve itself comes out the same again.
  EXPECT_EQ(bytes(points), bytes(points_of(surface_of(icosphere(4)), {.points = 1000, .density = density, .seed = 3})));
}

TEST(Resample, GivesEveryPieceItsShareOfThePoints) {
  // Areas 1 : 4 : 9, each on a stretch of the curve of its own.
  const Surface surface =
      surface_of(merged(merged(icosphere(2), translated(icosphere(2, 2), {5, 0, 0})), translated(icosphere(2, 3), {0, 9, 0})));
  ASSERT_EQ(surface.curve->disc_begin.size(), 4u);
  for (const std::uint64_t n : {14u, 100u, 1999u}) {
    std::array<int, 3> count{};
    for (const std::uint32_t l : points_of(surface, {.points = n}).vertices) {
      ++count[l < surface.curve->disc_begin[1] ? 0 : l < surface.curve->disc_begin[2] ? 1 : 2];
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(count[i], static_cast<double>(n) * (i + 1) * (i + 1) / 14, 1.01) << "piece " << i << " of " << n << " points";
    }
  }
}

TEST(Resample, SpreadsUniformPointsEvenly) {
  // Zones of equal height have equal area on a sphere; random points would miss by 14 here.
  std::array<int, 10> count{};
  for (const Vec3f& p : points_of(ball(), {.points = 2000}).positions) {
    ++count[static_cast<std::size_t>(std::clamp(5 * (p.z() + 1), 0.0f, 9.0f))];
  }
  for (const int c : count) EXPECT_NEAR(c, 200, 25);
}

TEST(Resample, PutsNothingOnBackFaces) {
  const Vec3d eye(0, 0, 3);
  const PointSet points = points_of(ball(), {.points = 1500, .density = seen_from(eye)});
  expect_on_surface(ball(), points, 1500, 2e-6);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d place = points.positions[i].cast<double>();
    EXPECT_GT((eye - place).normalized().dot(points.normals[i].cast<double>()), -1e-6) << "point " << i;
  }
}

TEST(Resample, MakesRadiiForTheLocalDensity) {
  const Density terms = seen_from(Vec3d(0, 0, 4), {ViewTerm{.s0 = 0.2}});
  const PointSet points = points_of(ball(), {.points = 2000, .density = terms});
  std::vector<float> density(ball().curve->size());
  ASSERT_TRUE(evaluate_density(*ball().curve, terms, density).ok());
  const double constant = points.radii[0] * std::sqrt(density[points.vertices[0]]);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points.radii[i] * std::sqrt(density[points.vertices[i]]), constant, 1e-5 * constant) << "point " << i;
  }
  // Four times as many points stand for a quarter of the area each.
  const PointSet few = points_of(ball(), {.points = 500, .density = terms});
  EXPECT_NEAR(few.radii[0] * std::sqrt(density[few.vertices[0]]), 2 * constant, 1e-3 * constant);
}

TEST(Resample, CoversTheSurfaceWithItsDiscs) {
  for (const PolygonSoup& soup : {icosphere(4), torus(40, 20), perforated_slab(5, 5)}) {
    const Surface surface = surface_of(soup);
    const SurfaceCurve& curve = *surface.curve;
    const PointSet points = points_of(surface, {.points = 1000});
    double covered = 0, discs = 0;
    for (std::size_t l = 0; l < curve.size(); ++l) {
      const Vec3f place(curve.x[l], curve.y[l], curve.z[l]);
      bool inside = false;
      for (std::size_t i = 0; i < points.size() && !inside; ++i) inside = (points.positions[i] - place).norm() < points.radii[i];
      if (inside) covered += curve.area[l];
    }
    for (const float r : points.radii) discs += std::numbers::pi * r * r;
    EXPECT_GT(covered / curve.total_area, 0.98);
    EXPECT_LT(discs / curve.total_area, 5);  // without waste
  }
}

TEST(Resample, KeepsItsPrecisionFarOut) {
  const Vec3d far(1e7, -1e7, 2e7);
  const Surface surface = surface_of(translated(icosphere(4), far));
  const PointSet points = points_of(surface, {.points = 2000});
  EXPECT_LT((points.origin - far).norm(), 10);
  expect_on_surface(surface, points, 2000, 1e-6);
  const PointSet seen = points_of(surface, {.points = 500, .density = seen_from(far + Vec3d(0, 0, 5))});
  for (const Vec3f& p : seen.positions) EXPECT_GT((seen.origin + p.cast<double>() - far).z(), 0.1);
}

TEST(Resample, ReportsTimesAndHowFineTheCurveIs) {
  ResampleReport report{-1, -1, -1};
  ASSERT_TRUE(resample(*ball().curve, {.points = kMaxPointsHere}, &report).ok());
  EXPECT_GE(report.density_seconds, 0);
  EXPECT_GE(report.equalise_seconds, 0);
  // What the curve was made for: omega = 10 vertices for each point, and no vertex of more than its share.
  EXPECT_LE(report.most_on_vertex, 0.1 * 1.0001);
  EXPECT_GT(report.most_on_vertex, 0.1 / 4.1);
  const double most = report.most_on_vertex;
  ASSERT_TRUE(resample(*ball().curve, {.points = 50 * kMaxPointsHere}, &report).ok());
  EXPECT_NEAR(report.most_on_vertex, 50 * most, 1e-9);
}

TEST(Resample, RefusesCountsOutOfRange) {
  const SurfaceCurve& curve = *ball().curve;
  EXPECT_EQ(resample(curve, {.points = 0}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(resample(curve, {.points = kMaxPointsHere}).ok());
  for (const std::uint64_t n : {kMaxPoints + 1, std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
    const absl::Status status = resample(curve, {.points = n}).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kOutOfRange);
    EXPECT_THAT(std::string(status.message()), HasSubstr("4000000"));
  }
}

TEST(Resample, GivesTheBestThatACoarseCurveCan) {
  const std::uint64_t many = 3 * ball().curve->size();
  const PointSet points = points_of(ball(), {.points = many});
  expect_on_surface(ball(), points, many, 2e-6);
  // Evenly all the same: no vertex has more than its share, rounded up twice.
  const auto& v = points.vertices;
  for (std::size_t i = 0; i + 16 < v.size(); ++i) ASSERT_LT(v[i], v[i + 16]);
}

TEST(Resample, SaysWhenNothingFacesTheEye) {
  const absl::StatusOr<PointSet> inside = resample(*ball().curve, {.points = 10, .density = seen_from(Vec3d(0, 0.1, 0))});
  EXPECT_EQ(inside.status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST(Resample, RefusesBadDensities) {
  const absl::StatusOr<PointSet> bad = resample(*ball().curve, {.points = 10, .density = {CurvatureTerm{.exponent = -1}}});
  EXPECT_EQ(bad.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(bad.status().message()), HasSubstr("exponent"));
}

}  // namespace
}  // namespace curvecast
