#include "core/flatten/vertex_stretch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace curvecast {
namespace {

struct Ring {
  Vec3d centre;
  std::vector<Vec3d> positions;
  std::vector<Vec2d> uv;
};

/// A bent fan of n triangles on the surface, over an uneven star in the plane.
Ring random_ring(int n, std::mt19937& random) {
  std::uniform_real_distribution<double> noise(-1, 1);
  Ring ring{{0, 0, 0.3 * noise(random)}, {}, {}};
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.3 * noise(random)) / n;
    const double r = 1 + 0.5 * noise(random), s = 1 + 0.6 * noise(random);
    ring.positions.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.4 * noise(random));
    ring.uv.emplace_back(s * std::cos(angle), s * std::sin(angle));
  }
  return ring;
}

VertexStretch fill(const Ring& ring, bool closed, double surface = 0) {
  VertexStretch stretch(surface);
  stretch.reset(ring.centre, closed);
  for (std::size_t i = 0; i < ring.uv.size(); ++i) stretch.add_neighbour(ring.positions[i], ring.uv[i]);
  stretch.finish();
  return stretch;
}

TEST(VertexStretch, EnergyIsTheAreaOfAnIsometricMap) {
  Ring ring{{0, 0, 0}, {}, {}};
  for (int i = 0; i < 6; ++i) {
    ring.positions.emplace_back(std::cos(i), std::sin(i), 0);
    ring.uv.emplace_back(std::cos(i), std::sin(i));
  }
  EXPECT_NEAR(fill(ring, false).energy({0, 0}), 5 * 0.5 * std::sin(1.0), 1e-6);
  for (Vec2d& x : ring.uv) x *= 0.5;  // half as long in the plane: stretched by two, squared
  EXPECT_NEAR(fill(ring, false).energy({0, 0}), 4 * 5 * 0.5 * std::sin(1.0), 1e-6);
}

TEST(VertexStretch, SpreadingOutCostsATenthOfWhatSqueezingDoes) {
  Ring ring{{0, 0, 0}, {}, {}};
  for (int i = 0; i < 6; ++i) {
    ring.positions.emplace_back(std::cos(i), std::sin(i), 0);
    ring.uv.emplace_back(std::cos(i), std::sin(i));
  }
  const double area = 5 * 0.5 * std::sin(1.0);
  EXPECT_NEAR(fill(ring, false, 1).energy({0, 0}), 1.1 * area, 1e-6);
  for (Vec2d& x : ring.uv) x *= 2;
  EXPECT_NEAR(fill(ring, false, 1).energy({0, 0}), (0.25 + 0.1 * 4) * area, 1e-6);
}

TEST(VertexStretch, FlippedAndEmptyTrianglesAreInvalid) {
  std::mt19937 random(1);
  const Ring ring = random_ring(6, random);
  const VertexStretch stretch = fill(ring, true);
  EXPECT_TRUE(stretch.valid({0, 0}));
  EXPECT_FALSE(stretch.valid({9, 0}));
  EXPECT_FALSE(stretch.valid(ring.uv[2]));
}

TEST(VertexStretch, StepsNeverRaiseTheEnergyAndEndAtAStationaryPoint) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const VertexStretch stretch = fill(random_ring(3 + trial % 9, random), true);
    Vec2d uv(0, 0);
    ASSERT_TRUE(stretch.valid(uv));
    double before = stretch.energy(uv);
    for (int step = 0; step < 60; ++step) {
      const double fall = stretch.improve(uv, std::nullopt).fall;
      ASSERT_TRUE(stretch.valid(uv));
      ASSERT_NEAR(before - fall, stretch.energy(uv), 1e-9 * before);
      ASSERT_GE(fall, 0);
      before -= fall;
    }
    // Nothing near by is lower.
    for (int i = 0; i < 8; ++i) {
      const Vec2d near = uv + 1e-3 * Vec2d(std::cos(i), std::sin(i));
      EXPECT_GE(stretch.energy(near), (1 - 1e-6) * before);
    }
  }
}

TEST(VertexStretch, ABorderVertexStaysOnItsSide) {
  const Ring ring{{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, {{1, 0}, {0.4, 0.6}, {0, 0}}};
  const VertexStretch stretch = fill(ring, false);
  Vec2d uv(0.9, 0);
  for (int i = 0; i < 30; ++i) stretch.improve(uv, Vec2d::UnitX());
  EXPECT_EQ(uv.y(), 0);
  EXPECT_GT(uv.x(), 0.3);
  EXPECT_LT(uv.x(), 0.7);
}

TEST(VertexStretch, PlacesVerticesWhereverThereIsRoom) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    Ring ring = random_ring(3 + trial % 10, random);
    // Seen from one of its corners the star is whole, as after a collapse; move that corner far in.
    const VertexStretch stretch = fill(ring, true);
    const std::optional<Vec2d> place = stretch.place();
    ASSERT_TRUE(place.has_value());
    EXPECT_TRUE(stretch.valid(*place));
  }
  // A star of which little is visible from anywhere: a thin L.
  const Ring corner{{0, 0, 0},
                    {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, -1, 0}},
                    {{1, 0}, {1, 0.01}, {0.01, 0.01}, {0.01, 1}, {0, 1}, {0, 0}}};
  const VertexStretch thin = fill(corner, true);
  const std::optional<Vec2d> place = thin.place();
  ASSERT_TRUE(place.has_value());
  EXPECT_TRUE(thin.valid(*place));
  // And one that has no such place.
  const Ring none{{0, 0, 0}, {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 0}, {0, 1}, {1, 0}, {1, 1}}};
  EXPECT_FALSE(fill(none, true).place().has_value());
}

TEST(VertexStretch, PlacesBorderVerticesBetweenTheirNeighbours) {
  const Ring ring{{0.75, 0, 0}, {{1, 0, 0}, {0.5, 1, 0}, {0, 0, 0}}, {{1, 0}, {0.5, 0.5}, {0, 0}}};
  const std::optional<Vec2d> place = fill(ring, false).place();
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->x(), 0.75, 1e-12);  // by length
  EXPECT_EQ(place->y(), 0);
}

TEST(VertexStretch, NeedlesResistCollapse) {
  // Three of the surface's points lie on one line: its triangle has no area, but must keep some in the plane.
  const Ring ring{{0, 0, 0}, {{1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, {{1, 0}, {1, 0.5}, {0, 1}, {-1, -1}}};
  const VertexStretch stretch = fill(ring, true);
  Vec2d uv(0, 0);
  for (int i = 0; i < 100; ++i) stretch.improve(uv, std::nullopt);
  EXPECT_TRUE(stretch.valid(uv));
  EXPECT_LT(stretch.energy(uv), 1e3);
}

}  // namespace
}  // namespace curvecast
