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

DiscOutline outline(const std::vector<SplatVertex>& splats) {
  const std::vector<std::uint32_t> near{0, 1, 2, 3, 4, 5, 6, 7, 8};
  return disc_outline(splats, 0, near);
}
float slimness(const std::vector<SplatVertex>& splats) { return outline(splats).slimness; }

/// How far beyond the disc's middle it ends in the picture; infinity where it does not.
float beyond_middle(const std::vector<SplatVertex>& splats) {
  const std::array<float, 4> plane = outline(splats).plane;
  const Vec3f out(plane[0], plane[1], plane[2]);
  if (out.isZero()) return std::numeric_limits<float>::infinity();
  EXPECT_NEAR(out.z(), 0, 1e-3F) << "the plane lies along the eye's rays";
  return plane[3] - out.dot(kCentre);
}

TEST(DiscOutline, DiscsOnWhatIsFlatOrHollowAreWhole) {
  for (const float facing : {1.0F, 0.5F, 0.1F, 0.02F, -0.1F}) {
    EXPECT_EQ(slimness(patch(1e4F, facing)), 1) << facing;
    EXPECT_EQ(slimness(patch(-0.3F, std::abs(facing))), 1) << facing;
  }
}

TEST(DiscOutline, DiscsAtOutlinesEndWhereTheSurfaceDoes) {
  const float radius = 0.5F;  // five of the discs'
  for (const float facing : {0.6F, 0.45F, 0.3F}) EXPECT_NEAR(slimness(patch(radius, facing)), 0.3F * facing * 5, 0.03F) << facing;
  EXPECT_EQ(slimness(patch(radius, 0.9F)), 1);
  EXPECT_EQ(slimness(patch(radius, 0.01F)), kLeastSlimness);
  // From behind, a hollow is what bends away.
  EXPECT_NEAR(slimness(patch(-radius, -0.4F)), 0.6F, 0.03F);
}

TEST(DiscOutline, NeighboursBeyondACreaseDoNotCount) {
  std::vector<SplatVertex> splats = patch(1e4F, 0.1F);
  splats[1].normal = {-1, 0, 0};
  splats[2].normal = {0, 1, 0};
  splats[5].normal = {0, 0, -1};
  EXPECT_EQ(slimness(splats), 1);
}

TEST(DiscOutline, ADiscAloneIsWhole) {
  EXPECT_EQ(disc_outline(patch(1, 0.1F), 0, {}).slimness, 1);
  EXPECT_EQ(disc_outline(patch(1, 0.1F), 0, {}).plane, (std::array<float, 4>{}));
}

TEST(DiscOutline, ItEndsWhereASphereDoes) {
  const float radius = 0.5F;
  for (const float facing : {0.4F, 0.2F, 0.1F}) {
    const float sine = std::sqrt(1 - facing * facing);
    EXPECT_NEAR(beyond_middle(patch(radius, facing)), radius * (1 - sine), 0.1F * radius * (1 - sine) + 1e-4F) << facing;
  }
  EXPECT_EQ(beyond_middle(patch(radius, 0.9F)), std::numeric_limits<float>::infinity());
  EXPECT_EQ(beyond_middle(patch(1e4F, 0.1F)), std::numeric_limits<float>::infinity()) << "there are others beyond";
}

TEST(DiscOutline, TheLastDiscBeforeAnOutlineEndsEarly) {
  const float facing = 0.2F;
  std::vector<SplatVertex> splats = patch(1e4F, facing);
  const auto lies_beyond = [](const SplatVertex& splat) { return splat.center[0] > 1e-3F; };
  for (SplatVertex& splat : splats) {
    if (lies_beyond(splat)) splat.center = to_array(kCentre - 10 * kRadius * Vec3f::UnitX());
  }
  EXPECT_NEAR(beyond_middle(splats), kLastReach * facing * kRadius, 1e-4F);
}

}  // namespace
}  // namespace curvecast
