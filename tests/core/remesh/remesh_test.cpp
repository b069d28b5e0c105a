#include "core/remesh/remesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>

#include "core/measure/hausdorff.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;
using Code = absl::StatusCode;

TEST(Remesh, HasExactlyTheVerticesAndKeepsTheTopology) {
  for (const auto& [name, shape] : remesh_shapes()) {
    for (const std::size_t n : {100u, 1'000u, 10'000u}) {
      SCOPED_TRACE(name + ", " + std::to_string(n));
      const auto made = remesh(shape, random_places(shape, n));
      ASSERT_TRUE(made.ok()) << made.status();
      EXPECT_EQ(made->mesh.vertex_count(), n);
      EXPECT_EQ(made->places.size(), n);
      expect_same_topology(made->mesh, shape);
      EXPECT_GT(least_angles(made->mesh).front(), 0);
      for (std::size_t i = 0; i < n; ++i) {
        const auto& [face, u, v] = made->places[i];
        ASSERT_LT(face, shape.face_count());
        const Triangle& t = shape.triangles[face];
        const Vec3d& a = shape.positions[t[0]];
        const Vec3d at = a + double{u} * (shape.positions[t[1]] - a) + double{v} * (shape.positions[t[2]] - a);
        ASSERT_NEAR((at - made->mesh.positions[i]).norm(), 0, 1e-5);
      }
    }
  }
}

TEST(Remesh, ComesNearerToTheSurfaceWithMoreVertices) {
  const TriangleMesh shape = make_mesh(torus(80, 60));
  double before = 1;
  for (const std::size_t n : {500u, 2'000u, 8'000u}) {
    const auto made = remesh(shape, random_places(shape, n));
    ASSERT_TRUE(made.ok()) << made.status();
    const HausdorffDistance distance = hausdorff_distance(shape, made->mesh, {.samples = 100'000});
    EXPECT_LT(distance.forward.rms, 0.4 * before);
    EXPECT_NEAR(surface_area(made->mesh), surface_area(shape), 40.0 / static_cast<double>(n) * surface_area(shape));
    before = distance.forward.rms;
  }
}

TEST(Remesh, TrianglesAreRegular) {
  const TriangleMesh shape = make_mesh(torus(80, 60));
  const auto made = remesh(shape, random_places(shape, 6'000), {.relaxations = 20});
  ASSERT_TRUE(made.ok()) << made.status();
  const std::vector<double> angles = least_angles(made->mesh);
  EXPECT_GT(angles[angles.size() / 2], 48);
  EXPECT_GT(angles[angles.size() / 100], 30);
}

TEST(Remesh, FlatPiecesKeepTheirOutline) {
  const TriangleMesh shape = make_mesh(square(9));
  for (const std::size_t n : {20u, 400u}) {
    const auto made = remesh(shape, random_places(shape, n));
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_EQ(made->mesh.vertex_count(), n);
    EXPECT_NEAR(surface_area(made->mesh), 1, 1e-9);
    const std::vector<double> angles = least_angles(made->mesh);
    EXPECT_GT(angles.front(), 5);
  }
}

TEST(Remesh, FeaturesStay) {
  const TriangleMesh box = make_mesh(perforated_slab(3, 3));  // with a tunnel: 24 edges
  for (const std::size_t n : {200u, 5'000u}) {
    for (const bool fit : {false, true}) {
      const auto made = remesh(box, random_places(box, n), {.fit = fit, .feature_degrees = 45});
      ASSERT_TRUE(made.ok()) << made.status();
      EXPECT_EQ(made->mesh.vertex_count(), n);
      expect_same_topology(made->mesh, box);
      const HausdorffDistance distance = hausdorff_distance(box, made->mesh, {.samples = 100'000});
      EXPECT_LT(distance.max(), 1e-6);
      EXPECT_NEAR(surface_area(made->mesh), surface_area(box), 1e-6);
      EXPECT_GT(least_angles(made->mesh).front(), 5);
      const auto without = remesh(box, random_places(box, n), {.fit = fit});
      EXPECT_GT(hausdorff_distance(box, without->mesh, {.samples = 100'000}).max(), 1e-3);
    }
  }
}

TEST(Remesh, FeaturesMeetBordersAndEndInside) {
  // A sheet with a fold that ends in its middle, and one from border to border.
  PolygonSoup sheet = square(40);
  for (Vec3d& p : sheet.positions) {
    if (p.y() <= 0.5) p.z() += std::max(0.0, p.x() - 0.25) * (0.5 - p.y());
    p.z() += std::max(0.0, p.x() - 0.75);
  }
  const TriangleMesh surface = make_mesh(sheet);
  const auto made = remesh(surface, random_places(surface, 2'000), {.feature_degrees = 20});
  ASSERT_TRUE(made.ok()) << made.status();
  expect_same_topology(made->mesh, surface);
  const auto without = remesh(surface, random_places(surface, 2'000));
  const double with = hausdorff_distance(surface, made->mesh).forward.rms;
  EXPECT_LT(with, 0.5 * hausdorff_distance(surface, without->mesh).forward.rms);
}

TEST(Remesh, PointsOnCommonLinesMakeNoFlatTriangles) {
  // A regular grid on the few faces of a cube: most points lie on lines with corners and with each other.
  const TriangleMesh shape = make_mesh(cube());
  std::vector<FacePlace> points;
  for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
    for (int i = 0; i < 32; ++i) {
      for (int j = 0; i + j < 32; ++j) points.push_back({f, static_cast<float>(i) / 32, static_cast<float>(j) / 32});
    }
  }
  for (const int relaxations : {0, 5}) {
    const auto made = remesh(shape, points, {.relaxations = relaxations});
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_EQ(made->mesh.vertex_count(), points.size());
    const std::vector<double> angles = least_angles(made->mesh);
    EXPECT_GT(angles[angles.size() / 100], relaxations == 0 ? 0.0 : 15.0);
    if (relaxations > 0) {
      EXPECT_GT(angles.front(), 0.1);
    }
  }
}

TEST(Remesh, SmallComponentsKeepWhatTheyStandOn) {
  // One ball has nearly all of the area: the other one gets a point or none.
  const TriangleMesh shape = make_mesh(merged(icosphere(4), translated(icosphere(2, 0.01), {2, 0, 0})));
  const auto made = remesh(shape, random_places(shape, 1'000));
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->mesh.vertex_count(), 1'000u);
  expect_same_topology(made->mesh, shape);
}

TEST(Remesh, TooFewPointsForTheTopologyAreAnError) {
  const TriangleMesh slab = make_mesh(perforated_slab(11, 11));
  const auto made = remesh(slab, random_places(slab, 20));
  EXPECT_EQ(made.status().code(), Code::kInvalidArgument);
  EXPECT_THAT(
      std::string(made.status().message()),
      ::testing::StartsWith("20 vertices are too few for a surface of 1 component, genus 25, 0 borders: it takes about "));
  const TriangleMesh cylinder = make_mesh(open_cylinder(10, 20));
  EXPECT_EQ(remesh(cylinder, random_places(cylinder, 4)).status().code(), Code::kInvalidArgument);
}

TEST(Remesh, RefusesPointsThatLieNowhere) {
  const TriangleMesh ball = make_mesh(icosphere(2));
  std::vector<FacePlace> points = random_places(ball, 50);
  EXPECT_EQ(remesh(ball, {}).status().code(), Code::kInvalidArgument);
  EXPECT_EQ(remesh(ball, points, {.relaxations = -1}).status().code(), Code::kInvalidArgument);
  EXPECT_EQ(remesh(ball, points, {.relaxations = 101}).status().code(), Code::kInvalidArgument);
  for (const double degrees : {-1.0, 181.0, std::nan("")}) {
    EXPECT_EQ(remesh(ball, points, {.feature_degrees = degrees}).status().code(), Code::kInvalidArgument);
  }
  for (const FacePlace& bad : {FacePlace{320, 0, 0}, {0, -0.1f, 0}, {0, 0.7f, 0.7f}, {0, NAN, 0}, {0, 0, INFINITY}}) {
    points[7] = bad;
    const absl::Status status = remesh(ball, points).status();
    EXPECT_EQ(status.code(), Code::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), ::testing::StartsWith("point 7 lies at weights"));
  }
}

TEST(Remesh, IsTheSameOnAnyNumberOfThreadsAndCanBeCancelled) {
  const TriangleMesh shape = make_mesh(open_cylinder(30, 40));
  const std::vector<FacePlace> points = random_places(shape, 3'000);
  const auto many = remesh(shape, points);
  tbb::task_arena alone(1);
  const auto one = alone.execute([&] { return remesh(shape, points); });
  ASSERT_TRUE(many.ok() && one.ok());
  EXPECT_EQ(one->mesh.positions, many->mesh.positions);
  EXPECT_EQ(one->mesh.triangles, many->mesh.triangles);
  const std::atomic<bool> cancel = true;
  EXPECT_EQ(remesh(shape, points, {}, {.on_progress = {}, .cancel = &cancel}).status().code(), Code::kCancelled);
}

}  // namespace
}  // namespace curvecast
