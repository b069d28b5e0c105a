#include "core/progressive/sample_ranked.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/measure/coverage.h"
#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

PointSet points_of(const std::shared_ptr<const RankTree>& tree, const Density& density, std::uint64_t n) {
  RankedWorkspace workspace;
  const absl::Status status = sample_ranked(*ball_curve(), tree, nullptr, density, n, workspace);
  EXPECT_TRUE(status.ok()) << status;
  return std::move(workspace.points);
}

TEST(SampleRanked, LieAlongTheCurve) {
  const PointSet points = points_of(ball_tree(8), view_from(Vec3d(1, 2, 2)), 9000);
  ASSERT_EQ(points.size(), 9000u);
  EXPECT_TRUE(std::is_sorted(points.vertices.begin(), points.vertices.end()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(points.positions[i].norm(), 1, 0.02);
    EXPECT_GT(points.normals[i].dot(ball_curve()->normal(points.vertices[i])), 0.99f);
    EXPECT_GT(points.radii[i], 0);
  }
  std::vector<std::uint32_t> ranks = points.ranks;
  std::sort(ranks.begin(), ranks.end());
  EXPECT_EQ(std::unique(ranks.begin(), ranks.end()), ranks.end());
}

TEST(SampleRanked, DiscsLeaveNoHoles) {
  const auto tree = ball_tree(7);
  for (const std::uint64_t n : {1000u, 1024u, 3000u, 9999u}) {
    const PointSet points = points_of(tree, {}, n);
    std::vector<Vec3d> positions;
    for (const Vec3f& p : points.positions) positions.push_back(points.origin + p.cast<double>());
    const double hole = coverage_radius(ball().flattened->loaded.mesh, PointCloud(positions, ball_curve()->box));
    EXPECT_LT(hole, *std::min_element(points.radii.begin(), points.radii.end())) << n;
  }
}

TEST(SampleRanked, WherePointsLackThoseThereAreGrow) {
  // Four times as many are wanted: those that there are stand for four times the area.
  const PointSet coarse = points_of(ball_tree(6), {}, 16'384);
  ASSERT_EQ(coarse.size(), 4096u);
  const double least = 1.25 * std::sqrt(ball_curve()->total_area / 4096);
  EXPECT_GE(coarse.radii[0], least * 0.9999);
  EXPECT_LT(coarse.radii[0], least * std::exp2(0.25));
}

/// Makes what a view lacks.
PointSet all_points_of(RankGrower& grower, const Density& density, std::uint64_t n) {
  RankedWorkspace workspace;
  for (int round = 0; round < 4 * kMaxRankLevel; ++round) {
    EXPECT_TRUE(sample_ranked(*ball_curve(), grower.tree(), nullptr, density, n, workspace).ok());
    if (workspace.selection.lacking.empty()) break;
    EXPECT_TRUE(grower.grow(workspace.selection.most_lacking(), 4'000'000).ok());
  }
  return std::move(workspace.points);
}

TEST(SampleRanked, ViewsHaveAllTheirPointsHoweverNear) {
  const auto grower = ball_grower(6);
  for (const double distance : {0.2, 0.02, 0.002, 0.0005}) {
    const Camera above{.eye = Vec3d(0, 0, 1 + distance), .target = Vec3d::Zero(), .fov = 0.6};
    const PointSet points = all_points_of(*grower, {{ScreenTerm{}, FrustumTerm{}}, {above}}, 5000);
    EXPECT_EQ(points.size(), 5000u) << distance;
    // A picture's width of some distance, filled with points: their discs are as small.
    EXPECT_LT(*std::max_element(points.radii.begin(), points.radii.end()), 0.1 * distance) << distance;
  }
}

TEST(SampleRanked, ShowsWhatTheCameraSeesAndNothingElse) {
  const auto grower = ball_grower(6);
  const Camera camera{.eye = Vec3d(0.3, 0.5, 3), .target = Vec3d(0.2, 0.3, 0), .fov = 0.35};
  const PointSet points = all_points_of(*grower, {{ViewTerm{.s0 = 1e6}, FrustumTerm{}}, {camera}}, 3000);
  ASSERT_EQ(points.size(), 3000u);
  const CameraAxes axes = axes_of(camera);
  const double reach = std::tan(camera.fov / 2);
  constexpr int kCells = 8;
  int in_cell[kCells][kCells] = {};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d ray = points.origin + points.positions[i].cast<double>() - camera.eye;
    const double x = ray.dot(axes.right) / ray.dot(axes.forward) / reach, y = ray.dot(axes.up) / ray.dot(axes.forward) / reach;
    ASSERT_LE(std::max(std::abs(x), std::abs(y)), 1.0001);
    ASSERT_LT(ray.dot(points.normals[i].cast<double>()), 0);
    ++in_cell[std::min(kCells - 1, static_cast<int>((x + 1) / 2 * kCells))]
             [std::min(kCells - 1, static_cast<int>((y + 1) / 2 * kCells))];
  }
  // The picture is full of the ball, which faces the camera there at various slants.
  for (const auto& column : in_cell) {
    for (const int count : column) EXPECT_GT(count, 3000 / kCells / kCells / 3);
  }
}

TEST(SampleRanked, SilhouettesHaveTheirShare) {
  constexpr double kS0 = 0.25;
  const auto grower = ball_grower(6);
  const Density density = {{ViewTerm{.s0 = kS0}}, {Camera{.eye = Vec3d(0, 0, 1e4), .target = Vec3d::Zero()}}};
  const PointSet points = all_points_of(*grower, density, 40'000);
  ASSERT_EQ(points.size(), 40'000u);
  // Zones of the same height have the same area; from far away the cosine is the height.
  const auto in_zone = [&](double low, double high) {
    return static_cast<double>(std::count_if(points.normals.begin(), points.normals.end(), [&](const Vec3f& n) {
      return static_cast<double>(n.z()) >= low && static_cast<double>(n.z()) < high;
    }));
  };
  const double ratio = in_zone(0, 0.05) / in_zone(0.95, 1.01);
  EXPECT_NEAR(ratio / ((1 + kS0 - 0.025) / (kS0 + 0.025)), 1, 0.05);
  EXPECT_EQ(in_zone(-1.01, 0), 0);
}

TEST(SampleRanked, RefusesWhatCannotBe) {
  const auto tree = ball_tree(8);
  RankedWorkspace workspace;
  const auto code = [&](const Density& density, std::uint64_t n) {
    return sample_ranked(*ball_curve(), tree, nullptr, density, n, workspace).code();
  };
  EXPECT_EQ(code({}, 0), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code({}, kMaxPoints + 1), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(code({ViewTerm{}}, 5), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code(view_from(Vec3d(0.1, 0.2, 0.1)), 5), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(code(view_from(Vec3d(NAN, 0, 3)), 5), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast
