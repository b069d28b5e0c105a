#include "core/measure/hausdorff.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/measure/triangle_tree.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using testing::make_mesh;
using testing::translated;

constexpr HausdorffOptions kSome{.samples = 100'000};
const double kTiny = kHausdorffFloor * 4;

TEST(Hausdorff, OfOffsetPlanes) {
  const TriangleMesh low = make_mesh(testing::square(10)), high = make_mesh(translated(testing::square(7), {0, 0, 0.25}));
  const HausdorffDistance found = hausdorff_distance(low, high, kSome);
  for (const SurfaceDistance& side : {found.forward, found.backward}) {
    EXPECT_DOUBLE_EQ(side.max, 0.25);
    EXPECT_NEAR(side.mean, 0.25, 1e-12);
    EXPECT_NEAR(side.rms, 0.25, 1e-12);
    EXPECT_NEAR(side.normal_rms, 0, 1e-5);
  }
  EXPECT_DOUBLE_EQ(found.max(), 0.25);
}

TEST(Hausdorff, IsWeighedByDepthForCameras) {
  // Two offset planes: the nearer to the eye, the more pixels.
  const TriangleMesh low = make_mesh(testing::square(10)), high = make_mesh(translated(testing::square(10), {0, 0, 0.01}));
  Camera camera;
  camera.target = {0.5, 0.5, 0};
  camera.fov = std::numbers::pi / 2;
  camera.pixels = 1000;
  HausdorffOptions options = kSome;
  for (const double height : {2.0, 20.0}) {
    camera.eye = {0.5, 0.5, height};
    options.cameras = {camera};
    const SurfaceDistance side = hausdorff_distance(low, high, options).forward;
    EXPECT_NEAR(side.picture_mean, 0.01 * 500 / height, 1e-9);
    EXPECT_NEAR(side.picture_rms, side.picture_mean, 1e-9);
    EXPECT_NEAR(side.picture_max, side.picture_mean, 1e-9);
    EXPECT_DOUBLE_EQ(side.picture_share, 1);
  }
  // From beside, half of it in the picture.
  camera.eye = {0.5, 0, 0.25};
  camera.target = {0.5, 0, 0};
  camera.up = {0, 1, 0};
  options.cameras = {camera};
  const SurfaceDistance side = hausdorff_distance(low, high, options).forward;
  EXPECT_NEAR(side.picture_share, 0.5 * 0.25, 0.01);
  EXPECT_EQ(hausdorff_distance(low, high, kSome).forward.picture_share, 0);
  EXPECT_DOUBLE_EQ(side.mean, hausdorff_distance(low, high, kSome).forward.mean);
}

TEST(Hausdorff, HasTwoSides) {
  // Half of a square lies beside the other one, the farthest part half a side away.
  const TriangleMesh whole = make_mesh(testing::square(8)), moved = make_mesh(translated(testing::square(5), {0.5, 0, 0}));
  const HausdorffDistance found = hausdorff_distance(whole, moved, kSome);
  EXPECT_DOUBLE_EQ(found.forward.max, 0.5);
  EXPECT_NEAR(found.forward.farthest.x(), 0, 1e-12);
  EXPECT_NEAR(found.forward.mean, 0.125, 1e-4);
  EXPECT_NEAR(found.forward.rms, std::sqrt(1.0 / 24), 1e-4);
  EXPECT_DOUBLE_EQ(found.backward.max, 0.5);
  // A small one within a large one: nothing one way, a corner's distance the other.
  const TriangleMesh part = make_mesh(testing::scaled(testing::square(3), 0.25));
  const HausdorffDistance within = hausdorff_distance(part, whole, kSome);
  EXPECT_LE(within.forward.max, kTiny);
  EXPECT_NEAR(within.backward.max, 0.75 * std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(within.max(), within.backward.max);
}

TEST(Hausdorff, OfSpheresOfTwoRadii) {
  // Between corners, edges and middles of faces: sagittas of both.
  const TriangleMesh inner = make_mesh(testing::icosphere(5)), outer = make_mesh(testing::icosphere(4, 1.5));
  const HausdorffDistance found = hausdorff_distance(inner, outer, kSome);
  for (const SurfaceDistance& side : {found.forward, found.backward}) {
    EXPECT_NEAR(side.max, 0.5, 5e-3);
    EXPECT_NEAR(side.mean, 0.5, 5e-3);
    EXPECT_NEAR(side.rms, 0.5, 5e-3);
    EXPECT_LT(side.normal_rms, 3);
    EXPECT_GT(side.normal_rms, 0.5);
  }
}

TEST(Hausdorff, OfNormals) {
  // Two walls of a roof over a floor, each at 45 degrees.
  const TriangleMesh roof = make_mesh(
      testing::soup_of({{0, 0, 0}, {1, 0, 1}, {2, 0, 0}, {0, 9, 0}, {1, 9, 1}, {2, 9, 0}}, {{0, 1, 4, 3}, {1, 2, 5, 4}}));
  const TriangleMesh floor = make_mesh(testing::soup_of({{0, 0, 0}, {2, 0, 0}, {2, 9, 0}, {0, 9, 0}}, {{0, 1, 2, 3}}));
  const SurfaceDistance side = hausdorff_distance(roof, floor, kSome).forward;
  EXPECT_DOUBLE_EQ(side.max, 1);
  EXPECT_NEAR(side.mean, 0.5, 1e-3);
  EXPECT_NEAR(side.normal_mean, 45, 1e-9);
  EXPECT_NEAR(side.normal_rms, 45, 1e-9);
}

TEST(Hausdorff, OfTheSameSurfaceIsNothing) {
  using namespace testing;
  for (const PolygonSoup& soup : {icosphere(3), torus(30, 20), perforated_slab(5, 5), single_triangle()}) {
    const HausdorffDistance found = hausdorff_distance(make_mesh(soup), make_mesh(soup), kSome);
    EXPECT_LE(found.max(), kTiny);
    EXPECT_LE(found.forward.rms, kTiny);
  }
  // Other triangles on the same planes.
  EXPECT_LE(hausdorff_distance(make_mesh(square(7)), make_mesh(square(13)), kSome).max(), kTiny);
  EXPECT_LE(hausdorff_distance(make_mesh(cube()), make_mesh(perforated_slab(1, 1)), kSome).backward.mean, 1);
}

TEST(Hausdorff, IsNoLessThanManySamplesAndNoMoreThanWhatLiesBetweenThem) {
  using namespace testing;
  const struct {
    PolygonSoup first, second;
  } pairs[] = {{jittered(icosphere(3), 0.1), jittered(icosphere(2), 0.2)},
               {torus(14, 9), torus(9, 14)},
               {jittered(square(9), 0.05), translated(jittered(square(4), 0.2), {0.1, 0, 0.01})},
               {perforated_slab(5, 3), cube()}};
  for (const auto& [one, other] : pairs) {
    const TriangleMesh first = make_mesh(one), second = make_mesh(other);
    const double found = hausdorff_distance(first, second, kSome).forward.max;
    const TriangleTree tree(second);
    double most = 0, step = 0;
    constexpr int kSteps = 60;
    for (const Triangle& t : first.triangles) {
      const Vec3d &a = first.positions[t[0]], b = first.positions[t[1]] - a, c = first.positions[t[2]] - a;
      step = std::max({step, b.norm() / kSteps, c.norm() / kSteps, (b - c).norm() / kSteps});
      for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; i + j <= kSteps; ++j) most = std::max(most, tree.nearest(a + (i * b + j * c) / kSteps).distance);
      }
    }
    EXPECT_GE(found, most / (1 + kHausdorffTolerance));
    EXPECT_LE(found, most + step);
  }
}

TEST(Hausdorff, SeesASpikeBetweenSamples) {
  // One narrow peak on a large plane; over it the other plane has no vertex.
  PolygonSoup peak = testing::square(40);
  peak.positions[20 * 41 + 20].z() = 0.3;
  const TriangleMesh with = make_mesh(peak), without = make_mesh(testing::square(3));
  EXPECT_NEAR(hausdorff_distance(with, without, {.samples = 1}).forward.max, 0.3, 1e-12);
  const double back = hausdorff_distance(without, with, {.samples = 1}).backward.max;
  EXPECT_NEAR(back, 0.3, 1e-12);
  // The other way: the plane's place below the peak is nearest to its flanks, which stand 1 / 40 away.
  const double below = hausdorff_distance(without, with, {.samples = 1}).forward.max;
  EXPECT_GT(below, 0.015);
  EXPECT_LT(below, 0.025);
}

TEST(Hausdorff, DoesNotDependOnMotionScaleOrderOrThreads) {
  const PolygonSoup one = testing::jittered(testing::torus(20, 12), 0.05), other = testing::torus(15, 15);
  const HausdorffDistance found = hausdorff_distance(make_mesh(one), make_mesh(other), kSome);
  const auto changed = [](PolygonSoup soup) {
    const Eigen::AngleAxisd turn(0.7, Vec3d(1, 2, 3).normalized());
    for (Vec3d& p : soup.positions) p = 1000 * (turn * p) + Vec3d(5e4, -3e4, 1e4);
    std::reverse(soup.indices.begin(), soup.indices.end());  // of triangles: other corners first, turned over
    return soup;
  };
  const HausdorffDistance far = hausdorff_distance(make_mesh(changed(one)), make_mesh(changed(other)), kSome);
  const auto expect_same = [](const SurfaceDistance& a, const SurfaceDistance& b, double scale) {
    EXPECT_NEAR(a.max * scale, b.max, 2 * kHausdorffTolerance * b.max);
    EXPECT_NEAR(a.mean * scale, b.mean, 1e-3 * b.mean);
    EXPECT_NEAR(a.rms * scale, b.rms, 1e-3 * b.rms);
    EXPECT_NEAR(a.normal_mean, b.normal_mean, 0.02 * b.normal_mean);
  };
  expect_same(found.forward, far.forward, 1000);
  expect_same(found.backward, far.backward, 1000);
  expect_same(hausdorff_distance(make_mesh(other), make_mesh(one), kSome).backward, found.forward, 1);
  tbb::task_arena alone(1);
  const HausdorffDistance again = alone.execute([&] { return hausdorff_distance(make_mesh(one), make_mesh(other), kSome); });
  EXPECT_EQ(again.forward.max, found.forward.max);
  EXPECT_EQ(again.forward.farthest, found.forward.farthest);
  EXPECT_EQ(again.backward.rms, found.backward.rms);
  EXPECT_EQ(again.backward.normal_rms, found.backward.normal_rms);
}

TEST(Hausdorff, EndsWhenCancelled) {
  const std::atomic<bool> cancel = true;
  const TriangleMesh mesh = make_mesh(testing::icosphere(4));
  hausdorff_distance(mesh, mesh, {}, {.on_progress = {}, .cancel = &cancel});
}

}  // namespace
}  // namespace curvecast
