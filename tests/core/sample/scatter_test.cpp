#include "core/sample/scatter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/measure/measure_points.h"
#include "core/mesh/crease_normals.h"
#include "core/mesh/curvature.h"
#include "core/sample/move_apart.h"
#include "core/sample/splat_radius.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

/// A mesh with all that scatter() wants of it.
struct Surface {
  explicit Surface(const PolygonSoup& soup)
      : mesh(testing::make_mesh(soup)),
        geometry(vertex_normals(mesh, VertexFans(mesh))),
        creases(crease_normals(mesh)),
        data(mesh, geometry, creases, attributes) {}
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  PointSet scatter(const ScatterOptions& options, const DensityAt& density = {}) const {
    absl::StatusOr<PointSet> points = curvecast::scatter(mesh, data, density, options);
    EXPECT_TRUE(points.ok()) << points.status();
    return points.ok() ? *std::move(points) : PointSet();
  }

  TriangleMesh mesh;
  std::vector<VertexGeometry> geometry;
  CreaseNormals creases;
  MeshAttributes attributes;
  SurfaceData data;
};

/// A density that is the same all over a face.
DensityAt by_face(std::span<const float> density) {
  return [density](std::span<const std::uint32_t> faces, std::span<const std::array<float, 2>>) {
    std::vector<float> values;
    for (const std::uint32_t face : faces) values.push_back(density[face]);
    return values;
  };
}

Vec3d position(const PointSet& points, std::size_t i) { return points.origin + points.positions[i].cast<double>(); }

/// Looks whether every face has the points that it should, to the last one, and whether all lie where they say.
void expect_shares(const Surface& surface, const PointSet& points, std::span<const float> density) {
  const TriangleMesh& mesh = surface.mesh;
  std::vector<double> wanted(mesh.face_count());
  double sum = 0;
  for (std::size_t f = 0; f < wanted.size(); ++f) {
    wanted[f] = triangle_area(mesh, f) * (density.empty() ? 1.0 : static_cast<double>(density[f]));
    sum += wanted[f];
  }
  std::vector<double> found(mesh.face_count());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [face, weight_1, weight_2] = points.places[i];
    ASSERT_GE(std::min({weight_1, weight_2, 1 - weight_1 - weight_2}), -1e-6F);
    const Triangle& t = mesh.triangles[face];
    const auto w1 = static_cast<double>(weight_1), w2 = static_cast<double>(weight_2);
    const Vec3d place = (1 - w1 - w2) * mesh.positions[t[0]] + w1 * mesh.positions[t[1]] + w2 * mesh.positions[t[2]];
    ASSERT_LT((position(points, i) - place).norm(), 1e-6);
    ASSERT_NEAR(points.normals[i].norm(), 1, 1e-5);
    ++found[face];
  }
  const double each = static_cast<double>(points.size()) / sum;
  for (std::size_t f = 0; f < wanted.size(); ++f) {
    ASSERT_LT(std::abs(found[f] - each * wanted[f]), 1 + 1e-6) << f;
    ASSERT_TRUE(wanted[f] > 0 || found[f] == 0) << f;
  }
}

TEST(Scatter, GivesEveryFaceItsShareToTheLastPoint) {
  const Surface ball(testing::jittered(testing::icosphere(3), 0.02)), cube(testing::cube());
  for (const Surface* surface : {&ball, &cube}) {
    std::vector<float> density(surface->mesh.face_count());
    for (std::size_t f = 0; f < density.size(); ++f) density[f] = f % 3 == 0 ? 0 : static_cast<float>(1 + f % 7);
    for (const std::uint64_t n : {1, 2, 777, 20'000}) {
      for (const std::uint64_t seed : {0, 1}) {
        const PointSet even = surface->scatter({.points = n, .seed = seed});
        ASSERT_EQ(even.size(), n);
        ASSERT_EQ(even.places.size(), n);
        ASSERT_EQ(even.radii.size(), n);
        expect_shares(*surface, even, {});
        expect_shares(*surface, surface->scatter({.points = n, .seed = seed}, by_face(density)), density);
      }
    }
  }
}

TEST(Scatter, FollowsADensityWithinFaces) {
  // Two triangles, and a density that grows from 0 at x = 0: the part of the points up to x is its square.
  const Surface square(testing::square(1));
  const Triangle* const triangles = square.mesh.triangles.data();
  const DensityAt x_of = [&](std::span<const std::uint32_t> faces, std::span<const std::array<float, 2>> weights) {
    std::vector<float> values;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Triangle& t = triangles[faces[i]];
      const auto x = [&](std::size_t k) { return static_cast<float>(square.mesh.positions[t[k]].x()); };
      values.push_back((1 - weights[i][0] - weights[i][1]) * x(0) + weights[i][0] * x(1) + weights[i][1] * x(2));
    }
    return values;
  };
  constexpr std::uint64_t kPoints = 10'000;
  for (const int rounds : {0, 3}) {
    const PointSet points = square.scatter({.points = kPoints, .rounds = rounds}, x_of);
    for (const double x : {0.1, 0.25, 0.5, 0.9}) {
      double found = 0;
      for (std::size_t i = 0; i < points.size(); ++i) found += position(points, i).x() < x;
      EXPECT_NEAR(found / kPoints, x * x, 0.005) << x << " after " << rounds;
    }
  }
}

TEST(Scatter, HalvesFacesEvenly) {
  // 4^k points on two triangles that make a square: each of the square's cells has one.
  const Surface square(testing::square(1));
  constexpr std::size_t kSide = 32;
  const PointSet points = square.scatter({.points = kSide * kSide});
  std::vector<int> in_cell(kSide * kSide);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p = kSide * position(points, i);
    ++in_cell[static_cast<std::size_t>(p.x()) + kSide * static_cast<std::size_t>(p.y())];
  }
  // Cells that the diagonal divides have halves of two faces.
  std::size_t others = 0;
  for (std::size_t c = 0; c < in_cell.size(); ++c) others += in_cell[c] != 1 && c / kSide != c % kSide;
  EXPECT_LT(others, in_cell.size() / 20);
  // Points that follow one another are neighbours.
  for (std::size_t i = 1; i < points.size(); ++i) {
    ASSERT_LT((position(points, i) - position(points, i - 1)).norm(), 2.0 / kSide);
  }
}

TEST(Scatter, IsFarMoreEvenThanChance) {
  const Surface ball(testing::jittered(testing::icosphere(4), 0.01));
  const PointSet points = ball.scatter({.points = 5'000});
  std::vector<std::vector<Vec3d>> sets(1);
  for (std::size_t i = 0; i < points.size(); ++i) sets[0].push_back(position(points, i));
  const absl::StatusOr<MeasureReport> report = measure_points(ball.mesh, sets, {});
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_LT(report->sets[0].ball.rms_relative, 0.25);
  EXPECT_LT(report->sets[0].ring.rms_relative, 0.25);
}

TEST(Scatter, MovesApart) {
  const Surface ball(testing::jittered(testing::icosphere(4), 0.01));
  const PointSet before = ball.scatter({.points = 4'000}), after = ball.scatter({.points = 4'000, .rounds = 3});
  const double spacing = std::sqrt(2 / std::sqrt(3) * surface_area(ball.mesh) / 4'000);
  double nearest = spacing;
  for (std::size_t i = 0; i < after.size(); ++i) {
    ASSERT_LT((position(after, i) - position(before, i)).norm(), 1.001 * kMostMove * spacing);
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (position(after, i) - position(after, j)).norm());
  }
  EXPECT_GT(nearest, 0.6 * spacing);
}

TEST(Scatter, RadiiAreOfTheAreaThatAPointHas) {
  const Surface square(testing::square(4));
  std::vector<float> density(square.mesh.face_count(), 1);
  std::fill_n(density.begin(), density.size() / 2, 4.0F);
  const PointSet points = square.scatter({.points = 1'000}, by_face(density));
  double area = 0;
  for (const float radius : points.radii) area += SplatRadius::area_of_point(radius);
  EXPECT_NEAR(area, surface_area(square.mesh), 1e-3);
}

TEST(Scatter, DependsOnItsSeedAndNotOnThreads) {
  const Surface ball(testing::jittered(testing::icosphere(4), 0.01));
  const ScatterOptions options{.points = 30'000, .seed = 7, .rounds = 1};
  const PointSet many = ball.scatter(options), other = ball.scatter({.points = 30'000, .seed = 8, .rounds = 1});
  EXPECT_NE(many.positions, other.positions);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const PointSet alone = ball.scatter(options);
  EXPECT_EQ(many.positions, alone.positions);
  EXPECT_EQ(many.normals, alone.normals);
}

TEST(Scatter, SaysWhatItCannotDo) {
  const Surface cube(testing::cube());
  const auto error = [&](const ScatterOptions& options, const DensityAt& density = {}, const ExecutionContext& context = {}) {
    return scatter(cube.mesh, cube.data, density, options, context).status();
  };
  EXPECT_EQ(error({.points = 0}).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(error({.points = kMaxPoints + 1}).code(), absl::StatusCode::kOutOfRange);
  const std::vector<float> nothing(cube.mesh.face_count(), 0.0F);
  const absl::Status nowhere = error({.points = 10}, by_face(nothing));
  EXPECT_EQ(nowhere.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(nowhere.message()), HasSubstr("zero"));
  const absl::Status unknown = error({.points = 10}, [](auto, auto) { return absl::NotFoundError("no such number"); });
  EXPECT_EQ(unknown.code(), absl::StatusCode::kNotFound);
  const std::atomic<bool> cancel = true;
  EXPECT_EQ(error({.points = 10}, {}, {.cancel = &cancel}).code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
