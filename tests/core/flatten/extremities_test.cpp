#include "core/flatten/extremities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/minimise_stretch.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

/// A ball with six long fingers along the axes.
TriangleMesh fingers() {
  PolygonSoup soup = testing::icosphere(4);
  for (Vec3d& p : soup.positions) p *= 1 + 6 * std::pow(p.cwiseAbs().maxCoeff(), 24);
  return testing::make_mesh(soup);
}

double stretch_with(const TriangleMesh& mesh, const std::vector<std::uint32_t>& extremities) {
  const DiscMesh disc = *cut_to_disc(mesh, extremities);
  return measure_stretch(disc, *minimise_stretch(disc)).total;
}

TEST(Extremities, CutsToFingersLowerTheStretch) {
  const TriangleMesh mesh = fingers();
  const std::vector<std::uint32_t> found = find_extremities(mesh).vertices;
  ASSERT_GE(found.size(), 3u);
  const double with = stretch_with(mesh, found);
  EXPECT_LT(with, stretch_with(mesh, {found[0], found[1]}));
  EXPECT_LT(with, 2);
  // Cuts end on fingers, each on another.
  std::vector<int> ends;
  for (const std::uint32_t v : found) {
    Eigen::Index axis = 0;
    const double reach = mesh.positions[v].cwiseAbs().maxCoeff(&axis);
    if (reach > 3) ends.push_back(static_cast<int>(axis) * 2 + (mesh.positions[v][axis] > 0));
  }
  std::sort(ends.begin(), ends.end());
  EXPECT_GE(std::unique(ends.begin(), ends.end()) - ends.begin(), 3);
}

TEST(Extremities, AFlatDiscNeedsNone) {
  EXPECT_TRUE(find_extremities(testing::make_mesh(testing::disc(20, 40))).vertices.empty());
}

TEST(Extremities, SmallPiecesAndALimitOfNoneGetNone) {
  EXPECT_TRUE(find_extremities(testing::make_mesh(testing::cube())).vertices.empty());
  EXPECT_TRUE(find_extremities(fingers(), {.most = 0}).vertices.empty());
}

TEST(Extremities, StaysWithinTheLimit) { EXPECT_LE(find_extremities(fingers(), {.most = 3}).vertices.size(), 3u); }

}  // namespace
}  // namespace curvecast
