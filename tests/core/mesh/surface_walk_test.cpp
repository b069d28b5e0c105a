#include "core/mesh/surface_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/measure/triangle_tree.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(SurfaceWalk, FindsWhatATreeFinds) {
  // A bent surface without a second sheet near: the nearest place is reached by going nearer all the way.
  const TriangleMesh ball = make_mesh(jittered(icosphere(4), 0.005));
  const SurfaceWalk walk(ball);
  const TriangleTree tree(ball);
  for (std::uint64_t i = 0; i < 2'000; ++i) {
    const Vec3d p = Vec3d(random_unit(1, 3 * i) - 0.5, random_unit(1, 3 * i + 1) - 0.5, random_unit(1, 3 * i + 2) - 0.5);
    const Vec3d point = 1.05 * p.normalized();
    const NearestFace nearest = tree.nearest(point);
    // From a face about a tenth away.
    const std::uint32_t start = tree.nearest((point + Vec3d(0.1, 0, 0)).normalized()).face;
    const WalkPlace found = walk.nearest(start, point);
    ASSERT_NEAR((found.position - point).norm(), nearest.distance, 2e-3);
    ASSERT_TRUE(found.weight_1 >= 0 && found.weight_2 >= 0 && found.weight_1 + found.weight_2 <= 1 + 1e-12);
    ASSERT_NEAR((walk.place(found.face, found.weight_1, found.weight_2).position - found.position).norm(), 0, 1e-15);
  }
}

TEST(SurfaceWalk, StopsAtBordersAndCorners) {
  const TriangleMesh square = make_mesh(testing::square(6));
  const SurfaceWalk walk(square);
  const auto expect_place = [&](const Vec3d& point, const Vec3d& wanted) {
    for (std::uint32_t f = 0; f < square.face_count(); ++f) {
      EXPECT_NEAR((walk.nearest(f, point).position - wanted).norm(), 0, 1e-12) << f;
    }
  };
  expect_place({0.3, 0.41, 0.7}, {0.3, 0.41, 0});
  expect_place({-1, 0.4, 0.2}, {0, 0.4, 0});
  expect_place({3, 2, -1}, {1, 1, 0});
}

TEST(SurfaceWalk, GoesStraightOnInAPlane) {
  const TriangleMesh square = make_mesh(testing::square(9));
  const SurfaceWalk walk(square);
  std::size_t borders = 0;
  for (std::uint64_t i = 0; i < 2'000; ++i) {
    const auto face = static_cast<std::uint32_t>(random_unit(3, 5 * i) * static_cast<double>(square.face_count()));
    const double w1 = random_unit(3, 5 * i + 1), w2 = (1 - w1) * random_unit(3, 5 * i + 2);
    const WalkPlace from = walk.place(face, w1, w2);
    // What leaves the plane does not count.
    const Vec3d step(random_unit(3, 5 * i + 3) - 0.5, random_unit(3, 5 * i + 4) - 0.5, 0.3);
    const Vec3d aim = from.position + Vec3d(step.x(), step.y(), 0);
    const SurfaceWalk::End end = walk.straight(from, step);
    const bool is_inside = std::min(aim.x(), aim.y()) > 0 && std::max(aim.x(), aim.y()) < 1;
    ASSERT_EQ(end.border == kNone, is_inside);
    ASSERT_NEAR((walk.place(end.place.face, end.place.weight_1, end.place.weight_2).position - end.place.position).norm(), 0,
                1e-12);
    if (is_inside) {
      ASSERT_LT((end.place.position - aim).norm(), 1e-12);
      continue;
    }
    ++borders;
    const Vec3d& p = end.place.position;
    ASSERT_LT(std::min(std::min(p.x(), p.y()), 1 - std::max(p.x(), p.y())), 1e-12);
    // Where the straight line meets it.
    ASSERT_LT((p - from.position).cross(aim - from.position).norm(), 1e-12);
  }
  EXPECT_GT(borders, 200u);
}

TEST(SurfaceWalk, GoesStraightOnFromCornersThroughCornersAndAlongEdges) {
  const std::size_t side = 9;
  const TriangleMesh square = make_mesh(testing::square(side));
  const SurfaceWalk walk(square);
  const double edge = 1 / static_cast<double>(side);
  std::size_t count = 0;
  for (std::uint32_t f = 0; f < square.face_count(); ++f) {
    for (const Vec2d& weights : {Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1), Vec2d(0.5, 0.5), Vec2d(0.5, 0)}) {
      const WalkPlace from = walk.place(f, weights[0], weights[1]);
      for (int x = -2; x <= 2; ++x) {
        for (int y = -2; y <= 2; ++y) {
          const Vec3d aim = from.position + edge * Vec3d(x, y, 0);
          if (std::min(aim.x(), aim.y()) < 1e-9 || std::max(aim.x(), aim.y()) > 1 - 1e-9) continue;
          const SurfaceWalk::End end = walk.straight(from, edge * Vec3d(x, y, 0));
          ASSERT_LT((end.place.position - aim).norm(), 1e-12) << f << " " << weights.transpose() << " " << x << " " << y;
          ASSERT_GE(std::min(end.place.weight_1, end.place.weight_2), 0);
          ASSERT_LE(end.place.weight_1 + end.place.weight_2, 1 + 1e-12);
          ++count;
        }
      }
    }
  }
  EXPECT_GT(count, 1'000u);
}

TEST(SurfaceWalk, EndsAtFacesWithoutAnArea) {
  // The middle one of three faces has three corners on a line.
  TriangleMesh strip;
  strip.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, -1, 0}, {0.5, 0, 0}, {0.5, 1, 0}};
  strip.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 4}};
  strip.twins.assign(9, kNone);
  const auto join = [&](std::uint32_t a, std::uint32_t b) { strip.twins[a] = b, strip.twins[b] = a; };
  join(2, 3);
  join(5, 6);
  const SurfaceWalk walk(strip);
  const SurfaceWalk::End end = walk.straight(walk.place(0, 0.4, 0.2), {0, 1, 0});
  EXPECT_EQ(end.place.face, 0u);
  EXPECT_EQ(end.border, kNone);
  EXPECT_NEAR(end.place.position.y(), 0, 1e-12);
  const WalkPlace from = walk.place(1, 0.3, 0.3);
  EXPECT_EQ((walk.straight(from, {0, 1, 0}).place.position - from.position).norm(), 0);
}

TEST(SurfaceWalk, GoesStraightOnAroundACube) {
  // Once around four faces of a cube, from any place and in any direction, unfolded: a straight line on a strip four sides long.
  const TriangleMesh cube = make_mesh(testing::cube());
  const SurfaceWalk walk(cube);
  const Box3d box = bounding_box(cube);
  const double side = box.max.x() - box.min.x();
  for (std::uint32_t f = 0; f < cube.face_count(); ++f) {
    const WalkPlace from = walk.place(f, 0.3, 0.25);
    // Along an axis that lies in the face: the way comes back to where it began.
    for (const Vec3d& axis : {Vec3d(Vec3d::UnitX()), Vec3d(Vec3d::UnitY()), Vec3d(Vec3d::UnitZ())}) {
      if (std::abs(axis.dot(walk.normal(f))) > 0.5) continue;
      EXPECT_LT((walk.straight(from, 4 * side * axis).place.position - from.position).norm(), 1e-9) << f;
      const Vec3d half = walk.straight(from, 2 * side * axis).place.position;
      const Vec3d across = walk.normal(f);
      EXPECT_NEAR(std::abs((half - from.position).dot(across)), side, 1e-9);  // on the face opposite
    }
  }
}

TEST(SurfaceWalk, FollowsGreatCirclesOfABall) {
  const TriangleMesh ball = make_mesh(jittered(icosphere(3), 0.01));
  const SurfaceWalk walk(ball);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const auto face = static_cast<std::uint32_t>(random_unit(4, 4 * i) * static_cast<double>(ball.face_count()));
    const WalkPlace from = walk.place(face, 0.2, 0.5 * random_unit(4, 4 * i + 1));
    Vec3d step(random_unit(4, 4 * i + 2) - 0.5, random_unit(4, 4 * i + 3) - 0.5, 0.1);
    step -= step.dot(walk.normal(face)) * walk.normal(face);
    const WalkPlace there = walk.straight(from, step).place;
    // On a ball a way of this length ends where the great circle does, more or less.
    const double turned = std::acos(std::clamp(from.position.normalized().dot(there.position.normalized()), -1.0, 1.0));
    EXPECT_NEAR(turned, step.norm(), 0.06 * step.norm() + 0.01);
  }
}

TEST(SurfaceWalk, StaysOnItsSheet) {
  // Both sides of a slab: what lies below the lower one is nearest to it, but not for those who come from above.
  const TriangleMesh slab = make_mesh(merged(square(4), translated(square(4), {0, 0, 0.1})));
  const SurfaceWalk walk(slab);
  const auto upper = static_cast<std::uint32_t>(slab.face_count() - 1);
  EXPECT_NEAR(walk.nearest(upper, {0.5, 0.5, -1}).position.z(), 0.1, 1e-12);
  EXPECT_NEAR(walk.nearest(0, {0.5, 0.5, 1}).position.z(), 0, 1e-12);
}

}  // namespace
}  // namespace curvecast
