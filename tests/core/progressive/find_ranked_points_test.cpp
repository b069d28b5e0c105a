#include "core/progressive/find_ranked_points.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <utility>
#include <vector>

#include "core/progressive/progressive.h"
#include "tests/core/progressive/ranked_ball.h"
#include "tests/support/real_mesh.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;
using Code = absl::StatusCode;

std::vector<RankedPosition> positions_of(std::span<const RankedPoint> points) {
  std::vector<RankedPosition> positions;
  for (const RankedPoint& p : points) positions.push_back({p.curve_position, p.rank});
  return positions;
}

void expect_found_again(const std::shared_ptr<const LeafSurface>& surface, int level, std::uint64_t seed) {
  const auto made = ProgressiveRanks::make(surface, {.level = level, .seed = seed});
  ASSERT_TRUE(made.ok()) << made.status();
  const auto points = find_ranked_points(CurveStrata(*surface), level, seed, positions_of(made->points()));
  ASSERT_TRUE(points.ok()) << points.status();
  ASSERT_EQ(points->size(), made->points().size());
  for (std::size_t i = 0; i < points->size(); ++i) {
    ASSERT_EQ(std::memcmp(&(*points)[i], &made->points()[i], sizeof(RankedPoint)), 0) << level << ' ' << i;
  }
}

TEST(FindRankedPoints, ArePreciselyThoseThatWereMade) {
  for (const int level : {0, 1, 3, 5, 8}) expect_found_again(ball_surface(), level, 0);
  expect_found_again(ball_surface(), 6, 77);
}

// Leaves smaller and larger than grains, of a curve that is coarse for its points.
TEST(FindRankedPoints, OfCoarseCurvesToo) {
  absl::StatusOr<Preprocessed> coarse = preprocess({"ball.off", to_off(icosphere(3))}, {.points = 100});
  ASSERT_TRUE(coarse.ok()) << coarse.status();
  expect_found_again(leaf_surface(*coarse), 7, 3);
}

TEST(FindRankedPoints, OfARealMeshToo) {
  const RealMesh mesh = real_mesh("igea.ply");
  absl::StatusOr<Preprocessed> done = preprocess({mesh.name, mesh.bytes}, {.points = 20'000});
  ASSERT_TRUE(done.ok()) << done.status();
  expect_found_again(leaf_surface(*done), 8, 0);
}

TEST(FindRankedPoints, RefusesPositionsThatAreNoRanks) {
  const CurveStrata strata(*ball_surface());
  const auto made = ProgressiveRanks::make(ball_surface(), {.level = 5});
  ASSERT_TRUE(made.ok()) << made.status();
  const std::vector<RankedPosition> good = positions_of(made->points());
  ASSERT_TRUE(find_ranked_points(strata, 5, 0, good).ok());
  const auto is_refused = [&](std::vector<RankedPosition> positions, int level = 5) {
    return find_ranked_points(strata, level, 0, positions).status().code() == Code::kInvalidArgument;
  };
  EXPECT_TRUE(is_refused(good, 4));
  EXPECT_TRUE(is_refused(good, -1));
  EXPECT_TRUE(is_refused({}, 9)) << "points of free groups lie elsewhere";
  EXPECT_TRUE(is_refused({good.begin(), good.end() - 1}));
  std::vector<RankedPosition> bad = good;
  std::swap(bad[3], bad[4]);
  EXPECT_TRUE(is_refused(bad)) << "not in curve order";
  bad = good;
  bad[7].rank = bad[8].rank;
  EXPECT_TRUE(is_refused(bad)) << "a rank twice";
  bad[7].rank = 1024;
  EXPECT_TRUE(is_refused(bad)) << "a rank of another level";
}

TEST(FindRankedPoints, CanBeCancelled) {
  const auto made = ProgressiveRanks::make(ball_surface(), {.level = 5});
  ASSERT_TRUE(made.ok()) << made.status();
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_EQ(find_ranked_points(CurveStrata(*ball_surface()), 5, 0, positions_of(made->points()), context).status().code(),
            Code::kCancelled);
}

}  // namespace
}  // namespace curvecast
