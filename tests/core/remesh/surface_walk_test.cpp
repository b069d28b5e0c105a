#include "core/remesh/surface_walk.h"

#include <gtest/gtest.h>

#include "core/measure/triangle_tree.h"
#include "tests/core/remesh/remesh_cases.h"

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
