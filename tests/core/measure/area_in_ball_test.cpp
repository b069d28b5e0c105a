#include "core/measure/area_in_ball.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

constexpr double kPi = std::numbers::pi;

double whole(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return 0.5 * (b - a).cross(c - a).norm(); }

TEST(AreaInBall, OfWhatLiesInsideOrOutside) {
  const Vec3d a(0, 0, 0), b(4, 0, 0), c(0, 3, 0);
  EXPECT_NEAR(area_in_ball({1, 1, 1}, 10, a, b, c), 6, 1e-12);
  EXPECT_NEAR(area_in_ball({1, 1, 1}, 10, a, c, b), 6, 1e-12);  // seen from below
  EXPECT_EQ(area_in_ball({1, 1, 2}, 1.9, a, b, c), 0);          // above its plane
  EXPECT_NEAR(area_in_ball({9, 9, 0}, 3, a, b, c), 0, 1e-12);   // in its plane
  EXPECT_EQ(area_in_ball({1, 0, 0}, 5, a, b, 0.5 * (a + b)), 0);
  EXPECT_EQ(area_in_ball(a, 5, a, a, a), 0);
}

TEST(AreaInBall, OfACircleAndItsParts) {
  const Vec3d a(0, 0, 0), b(40, 0, 0), c(0, 40, 0);
  EXPECT_NEAR(area_in_ball({10, 10, 3}, 5, a, b, c), kPi * 16, 1e-11);     // within the triangle
  EXPECT_NEAR(area_in_ball({20, 0, 0}, 5, a, b, c), kPi * 25 / 2, 1e-11);  // on a side
  EXPECT_NEAR(area_in_ball({0, 0, 4}, 5, a, b, c), kPi * 9 / 4, 1e-11);    // over the right angle
  EXPECT_NEAR(area_in_ball({40, 0, 0}, 4, a, b, c), kPi * 16 / 8, 1e-11);  // at half of one
  // A segment of height 1 of a circle of radius 3.
  const double segment = 9 * std::acos(2.0 / 3) - 2 * std::sqrt(5.0);
  EXPECT_NEAR(area_in_ball({20, -2, 0}, 3, a, b, c), segment, 1e-11);
  EXPECT_NEAR(area_in_ball({20, 2, 0}, 3, a, b, c), kPi * 9 - segment, 1e-11);
}

TEST(AreaInBall, OfPartsAddUp) {
  std::uint64_t counter = 0;
  const auto vector = [&] {
    counter += 3;
    return Vec3d(random_unit(1, counter), random_unit(1, counter + 1), random_unit(1, counter + 2));
  };
  int partial = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3d centre = vector(), a = vector(), b = vector(), c = vector();
    const double radius = random_unit(2, i), across = random_unit(3, i), along = random_unit(4, i);
    const Vec3d inside = a + across * (b - a) + (1 - across) * along * (c - a);
    const double area = area_in_ball(centre, radius, a, b, c);
    EXPECT_NEAR(area_in_ball(centre, radius, inside, a, b) + area_in_ball(centre, radius, inside, b, c) +
                    area_in_ball(centre, radius, inside, c, a),
                area, 1e-12);
    EXPECT_LE(area, area_in_ball(centre, radius + 0.1, a, b, c) + 1e-12);
    partial += area > 0.01 * whole(a, b, c) && area < 0.99 * whole(a, b, c);
  }
  EXPECT_GT(partial, 100);
}

TEST(AreaInBall, OfASphereIsThatOfItsCap) {
  // A ball about a point of a sphere cuts off a cap of the area of a circle with the ball's radius (Archimedes).
  const TriangleMesh mesh = testing::make_mesh(testing::icosphere(6));
  for (const double radius : {0.1, 0.7, 1.3, 1.9}) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
      sum += area_in_ball(mesh.positions[0], radius, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
    }
    EXPECT_NEAR(sum / (kPi * radius * radius), 1, 1e-3) << radius;
  }
}

}  // namespace
}  // namespace curvecast
