#include "core/sample/sample_ranked.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/measure/coverage.h"
#include "tests/core/sample/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

PointSet points_of(const std::shared_ptr<const RankTree>& tree, const Density& terms, std::uint64_t n) {
  const ViewFactor view(*ball_curve(), terms);
  RankSelector selector;
  RankSelection selection;
  selector.select(tree, nullptr, view, n, selection);
  std::vector<RankRef> refs;
  list_shown(selection, refs);
  return ranked_points(*ball_curve(), selection, refs, nullptr, view);
}

TEST(RankedPoints, LieAlongTheCurve) {
  const PointSet points = points_of(ball_tree(8), view_from(Vec3d(1, 2, 2)), 9000);
  ASSERT_EQ(points.size(), 9000u);
  EXPECT_TRUE(std::is_sorted(points.vertices.begin(), points.vertices.end()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points.positions[i].norm(), 1, 0.02);
    EXPECT_EQ(points.normals[i], ball_curve()->normal(points.vertices[i]));
    EXPECT_GT(points.radii[i], 0);
  }
  std::vector<std::uint32_t> ranks = points.ranks;
  std::sort(ranks.begin(), ranks.end());
  EXPECT_EQ(std::unique(ranks.begin(), ranks.end()), ranks.end());
}

TEST(RankedPoints, DiscsLeaveNoHoles) {
  const auto tree = ball_tree(7);
  for (const std::uint64_t n : {1000u, 1024u, 3000u, 9999u}) {
    const PointSet points = points_of(tree, {}, n);
    std::vector<Vec3d> positions;
    for (const Vec3f& p : points.positions) positions.push_back(points.origin + p.cast<double>());
    const double hole = coverage_radius(ball().flattened->loaded.mesh, PointCloud(positions, ball_curve()->box));
    EXPECT_LT(hole, *std::min_element(points.radii.begin(), points.radii.end())) << n;
  }
}

TEST(RankedPoints, WherePointsLackThoseThereAreGrow) {
  // Four times as many are wanted: those that there are stand for four times the area.
  const PointSet coarse = points_of(ball_tree(6), {}, 16'384);
  ASSERT_EQ(coarse.size(), 4096u);
  EXPECT_NEAR(coarse.radii[0], 1.25 * std::sqrt(ball_curve()->total_area / 4096), 1e-4);
}

}  // namespace
}  // namespace curvecast
