#include "core/render/disc_outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {
namespace {

constexpr float kRadius = 0.1F;
const Vec3f kCentre(0, 0, -100);  // so far that all rays are parallel, nearly

std::array<float, 3> to_array(const Vec3f& v) { return {v.x(), v.y(), v.z()}; }

/// A disc on a sphere, or in a hollow, of such a radius, whose normal has such a cosine with the direction to the eye; and eight
/// about it.
std::vector<SplatVertex> patch(float radius, float facing) {
  const float angle = std::acos(facing);
  const Vec3f normal(std::sin(angle), 0, std::cos(angle)), along(std::cos(angle), 0, -std::sin(angle));
  std::vector<SplatVertex> splats{{to_array(kCentre), kRadius, to_array(normal), {}}};
  for (int i = 0; i < 8; ++i) {
    const float turn = 0.7F * static_cast<float>(i), step = kRadius / radius;
    const Vec3f way = std::cos(turn) * along + std::sin(turn) * Vec3f::UnitY();
    const Vec3f its = std::cos(step) * normal + std::sin(step) * way;
    splats.push_back({to_array(kCentre + radius * (its - normal)), kRadius, to_array(its), {}});
  }
  return splats;
}

std::array<float, 4> outline(const std::vector<SplatVertex>& splats) {
  const std::vector<std::uint32_t> near{0, 1, 2, 3, 4, 5, 6, 7, 8};
  return disc_outline(splats, 0, near, 0.766F);
}

/// How far beyond the disc's middle it ends in the picture; infinity where it does not.
float beyond_middle(const std::vector<SplatVertex>& splats) {
  const std::array<float, 4> plane = outline(splats);
  const Vec3f out(plane[0], plane[1], plane[2]);
  if (out.isZero()) return std::numeric_limits<float>::infinity();
  EXPECT_NEAR(out.z(), 0, 1e-3F) << "the plane lies along the eye's rays";
  EXPECT_GT(out.x(), 0);
  return plane[3] - out.dot(kCentre);
}

constexpr float kNowhere = std::numeric_limits<float>::infinity();

TEST(DiscOutline, DiscsOnWhatIsFlatOrHollowAreWhole) {
  for (const float facing : {1.0F, 0.5F, 0.1F, -0.1F}) {
    EXPECT_EQ(beyond_middle(patch(1e4F, facing)), kNowhere) << facing;
    EXPECT_EQ(beyond_middle(patch(-0.3F, std::abs(facing))), kNowhere) << facing;
  }
}

TEST(DiscOutline, ItEndsHalfwayToWhereASphereDoes) {
  const float radius = 0.5F;
  for (const float facing : {0.4F, 0.2F, 0.1F}) {
    const float end = radius * (1 - std::sqrt(1 - facing * facing));
    EXPECT_NEAR(beyond_middle(patch(radius, facing)), 0.5F * end, 0.1F * end + 1e-4F) << facing;
    EXPECT_NEAR(beyond_middle(patch(radius, -facing)), 0.5F * end, 0.1F * end + 1e-4F) << "a back of " << facing;
  }
}

TEST(DiscOutline, TheNormalsOfNeighboursBeyondACreaseDoNotCount) {
  std::vector<SplatVertex> splats = patch(1e4F, 0.1F);
  splats[1].normal = {-1, 0, 0};
  splats[2].normal = {0, 1, 0};
  splats[5].normal = {0, 0, -1};
  EXPECT_EQ(beyond_middle(splats), kNowhere);
}

TEST(DiscOutline, WhatNothingIsKnownOfIsWhole) {
  EXPECT_EQ(disc_outline(patch(1, 0.1F), 0, {}, 0.766F), (std::array<float, 4>{}));
}

TEST(DiscOutline, TheLastDiscBeforeAnOutlineEndsEarlyUnlessAllIsFlat) {
  const float facing = 0.2F;
  for (const float radius : {-0.5F, 1e4F}) {
    std::vector<SplatVertex> splats = patch(radius, facing);
    for (SplatVertex& splat : splats) {
      if (splat.center[0] > 1e-3F) splat.center = to_array(kCentre - 10 * kRadius * Vec3f::UnitX());
    }
    const float end = beyond_middle(splats);
    if (radius < 0)
      EXPECT_LT(end, 0.3F * facing * kRadius);
    else
      EXPECT_EQ(end, kNowhere);
  }
}

TEST(DiscOutline, ABumpEndsEarlyThoughItsNormalDoesNotLean) {
  const float facing = 0.2F;
  std::vector<SplatVertex> splats = patch(1e4F, facing);
  const Vec3f normal(splats[0].normal[0], splats[0].normal[1], splats[0].normal[2]);
  for (std::size_t i = 1; i < splats.size(); ++i) {
    const Vec3f centre(splats[i].center[0], splats[i].center[1], splats[i].center[2]);
    splats[i].center = to_array(centre - 0.3F * kRadius * normal);
  }
  EXPECT_LT(beyond_middle(splats), 0.3F * facing * kRadius);
}

}  // namespace
}  // namespace curvecast
