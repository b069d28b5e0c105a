#include "core/progressive/stratum_bounds.h"

#include <gtest/gtest.h>

#include "core/progressive/progressive.h"
#include "tests/core/progressive/ranked_ball.h"
#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// All points down to a level lie within the bounds of the strata of all chunks' runs above: points of the lowest ranks lie at
/// the vertices of leaves that are small beside these, but may be larger than deeper strata.
void expect_bounded(const std::shared_ptr<const LeafSurface>& surface, int level) {
  const CurveStrata strata(*surface);
  const StratumBounds bounds(strata);
  const auto ranks = ProgressiveRanks::make(surface, {.level = level});
  ASSERT_TRUE(ranks.ok()) << ranks.status();
  for (int l = 0; l <= level; ++l) {
    const std::size_t per_stratum = ranks->points().size() >> 2 * l;
    for (std::size_t i = 0; i < ranks->points().size(); i += per_stratum) {
      const StratumBound bound = bounds.of(l, i / per_stratum);
      for (const RankedPoint& p : ranks->points().subspan(i, per_stratum)) {
        if (l > 2 && p.rank >> 2 * (l + 3) == 0) continue;
        ASSERT_LE((Vec3f(p.position[0], p.position[1], p.position[2]) - bound.centre).norm(), bound.radius) << l;
        ASSERT_LE((Vec3f(p.normal[0], p.normal[1], p.normal[2]) - bound.normal).norm(), bound.spread + 1e-6f) << l;
        ASSERT_GE(p.vertex, bound.first_vertex);
        ASSERT_LE(p.vertex, bound.last_vertex);
      }
    }
  }
}

TEST(StratumBounds, HoldAllPoints) { expect_bounded(ball_surface(), 7); }

TEST(StratumBounds, HoldPointsWithinLeaves) {
  auto curve = flat_curve(3);
  curve->blocks = build_blocks(*curve);
  expect_bounded(flat_surface(curve), 7);
}

TEST(StratumBounds, AreNotMuchLarger) {
  const CurveStrata strata(*ball_surface());
  const StratumBounds bounds(strata);
  // A stratum of level 4 has 1 / 256 of the ball: a square of that area has half a diagonal of 0.157.
  double sum = 0;
  for (std::uint64_t i = 0; i < 256; ++i) sum += static_cast<double>(bounds.of(4, i).radius);
  EXPECT_LT(sum / 256, 0.3);
  EXPECT_LT(bounds.of(4, 77).spread, 0.4f);
}

}  // namespace
}  // namespace curvecast
