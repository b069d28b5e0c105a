#include "core/remesh/unfold.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

Vec3d normal(const Triangle& t, const std::vector<Vec3d>& at) { return (at[t[1]] - at[t[0]]).cross(at[t[2]] - at[t[0]]); }

TEST(Unfold, LeavesSmallMovesAlone) {
  const TriangleMesh ball = make_mesh(icosphere(3));
  std::vector<Vec3d> after = ball.positions;
  for (std::size_t v = 0; v < after.size(); ++v) after[v] += 1e-3 * Vec3d(v % 3, v % 5, v % 7);
  const std::vector<Vec3d> wanted = after;
  const std::vector<bool> back = unfold(ball.triangles, ball.positions, after);
  EXPECT_EQ(std::count(back.begin(), back.end(), true), 0);
  EXPECT_EQ(after, wanted);
}

TEST(Unfold, TakesBackWhatTurnsATriangleOver) {
  const TriangleMesh plane = make_mesh(square(4));
  std::vector<Vec3d> after = plane.positions;
  const Triangle& t = plane.triangles[5];
  after[t[0]] = plane.positions[t[1]] + plane.positions[t[2]] - plane.positions[t[0]];  // beyond the side across
  const std::vector<bool> back = unfold(plane.triangles, plane.positions, after);
  EXPECT_TRUE(back[t[0]]);
  EXPECT_EQ(after, plane.positions);
}

TEST(Unfold, LeavesNoTriangleTurnedOrFlatAfterWildMoves) {
  const TriangleMesh ball = make_mesh(icosphere(4));
  std::vector<Vec3d> after = ball.positions;
  const auto random = [](std::size_t i) { return static_cast<double>(mix_bits(i) % 10'000) / 10'000 - 0.5; };
  for (std::size_t v = 0; v < after.size(); ++v) after[v] += 0.15 * Vec3d(random(3 * v), random(3 * v + 1), random(3 * v + 2));
  const std::vector<bool> back = unfold(ball.triangles, ball.positions, after);
  const auto kept = std::count(back.begin(), back.end(), false);
  EXPECT_GT(kept, 0);
  EXPECT_LT(kept, static_cast<std::ptrdiff_t>(after.size()));
  for (std::size_t v = 0; v < after.size(); ++v) {
    if (back[v]) {
      EXPECT_EQ(after[v], ball.positions[v]);
    }
  }
  for (const Triangle& t : ball.triangles) {
    const Vec3d was = normal(t, ball.positions), is = normal(t, after);
    EXPECT_GT(was.dot(is), 0.24 * was.norm() * std::min(was.norm(), is.norm()));
  }
}

}  // namespace
}  // namespace curvecast
