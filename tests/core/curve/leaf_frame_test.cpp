#include "core/curve/leaf_frame.h"

#include <gtest/gtest.h>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(LeafFrame, OfASquareAreItsSides) {
  const auto curve = flat_curve(5);
  LeafFrames frames(*curve);
  for (std::size_t l = 0; l < curve->size(); ++l) {
    const LeafFrame frame = frames.of(l);
    EXPECT_LT((frame.along_x - Vec3f(1 / 32.0f, 0, 0)).norm(), 1e-6) << l;
    EXPECT_LT((frame.along_y - Vec3f(0, 1 / 32.0f, 0)).norm(), 1e-6) << l;
  }
}

TEST(LeafFrame, PartsOfALeafAreWhereAFinerCurveHasThem) {
  const auto curve = flat_curve(3), finer = flat_curve(7);
  LeafFrames frames(*curve);
  for (std::size_t i = 0; i < finer->size(); ++i) {
    const std::size_t l = i / 256;
    const Vec3f place = curve->position(l) + frames.of(l).offset((static_cast<double>(i % 256) + 0.5) / 256);
    EXPECT_LT((place - finer->position(i)).norm(), 1e-6) << i;
  }
}

TEST(LeafFrame, OfLeavesWithoutTwoDirectionsIsZero) {
  for (const int level : {0, 1}) {
    auto curve = flat_curve(level);
    // Only what lies on one side is left.
    curve->disc_begin = {0, 1};
    const LeafFrame frame = LeafFrames(*curve).of(0);
    EXPECT_EQ(frame.along_x, Vec3f::Zero());
    EXPECT_EQ(frame.offset(0.3), Vec3f::Zero());
  }
}

TEST(LeafFrame, DoesNotReachIntoAnotherDisc) {
  auto curve = flat_curve(4);
  curve->disc_begin = {0, 128, 256};
  for (std::size_t l = 128; l < 256; ++l) curve->x[l] += 100;
  LeafFrames frames(*curve);
  for (std::size_t l = 0; l < 256; ++l) EXPECT_LT(frames.of(l).along_x.norm(), 1) << l;
}

TEST(LeafFrame, IsZeroWhereTheNeighboursAreFarAway) {
  auto curve = flat_curve(4);
  for (std::size_t l = 100; l < 256; ++l) curve->z[l] += 100;
  LeafFrames frames(*curve);
  for (std::size_t l = 0; l < 256; ++l) EXPECT_LT(frames.of(l).offset(0.9).norm(), 1) << l;
}

}  // namespace
}  // namespace curvecast
