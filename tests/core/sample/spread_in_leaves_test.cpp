#include "core/sample/spread_in_leaves.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "core/pipeline/curve_surface.h"
#include "core/sample/resample.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

Preprocessed coarse_ball() {
  const std::string off = to_off(icosphere(3));
  absl::StatusOr<Preprocessed> done = preprocess({"ball.off", off}, {.points = 200});
  EXPECT_TRUE(done.ok()) << done.status();
  return *std::move(done);
}

std::size_t places_of(const PointSet& points) {
  std::set<std::tuple<float, float, float>> places;
  for (const Vec3f& p : points.positions) places.insert({p.x(), p.y(), p.z()});
  return places.size();
}

TEST(SpreadInLeaves, GivesEveryPointAPlaceOfItsOwnAndMovesNoOther) {
  const Preprocessed done = coarse_ball();
  const auto surface = leaf_surface(done);
  absl::StatusOr<PointSet> points = resample(*done.curve, {.points = 20'000});
  ASSERT_TRUE(points.ok()) << points.status();
  ASSERT_TRUE(shares_vertices(*points));
  ASSERT_LE(places_of(*points), done.curve->size());
  const PointSet before = *points;
  find_places(*done.curve, *points);
  spread_in_leaves(*surface, *points);
  EXPECT_EQ(places_of(*points), 20'000u);
  EXPECT_EQ(points->vertices, before.vertices);
  const TriangleMesh& mesh = done.flattened->loaded.mesh;
  for (std::size_t i = 0; i < points->size(); ++i) {
    const bool is_alone = (i == 0 || before.vertices[i - 1] != before.vertices[i]) &&
                          (i + 1 == points->size() || before.vertices[i + 1] != before.vertices[i]);
    if (is_alone) {
      EXPECT_EQ(points->positions[i], before.positions[i]);
      EXPECT_EQ(points->normals[i], before.normals[i]);
    }
    // Where its face and weights say: those of curve vertices have 16 bits.
    const FacePlace& at = points->places[i];
    const Triangle& t = mesh.triangles[at.face];
    const double w1 = static_cast<double>(at.weight_1), w2 = static_cast<double>(at.weight_2);
    const Vec3d p = (1 - w1 - w2) * mesh.positions[t[0]] + w1 * mesh.positions[t[1]] + w2 * mesh.positions[t[2]];
    EXPECT_LT((points->origin + points->positions[i].cast<double>() - p).norm(), is_alone ? 1e-4 : 1e-6) << i;
    EXPECT_NEAR(points->normals[i].norm(), 1, 1e-4);
  }
}

TEST(SpreadInLeaves, PointsOfALeafLieEvenly) {
  const Preprocessed done = coarse_ball();
  const auto surface = leaf_surface(done);
  // All in one leaf: as if a view were that near.
  const std::uint32_t l = 777;
  constexpr std::size_t kCount = 4096;
  PointSet points;
  points.positions.resize(kCount);
  points.normals.resize(kCount);
  points.vertices.assign(kCount, l);
  spread_in_leaves(*surface, points);
  // Nearest neighbours are about as far apart as in a grid of as many points.
  const double grid = std::sqrt(static_cast<double>(done.curve->area[l]) / kCount);
  std::size_t crowded = 0;  // where triangles meet
  for (std::size_t i = 0; i < kCount; ++i) {
    double nearest = 1e9;
    for (std::size_t j = 0; j < kCount; ++j) {
      if (j != i) nearest = std::min(nearest, static_cast<double>((points.positions[i] - points.positions[j]).norm()));
    }
    crowded += nearest < 0.25 * grid ? 1 : 0;
    EXPECT_LT(nearest, 2 * grid);
  }
  EXPECT_LT(crowded, kCount / 20);
}

TEST(SpreadInLeaves, LeavesPointsWithVerticesOfTheirOwnAlone) {
  const Preprocessed done = coarse_ball();
  absl::StatusOr<PointSet> points = resample(*done.curve, {.points = 20, .sequence = Sequence::kRegular});
  ASSERT_TRUE(points.ok());
  EXPECT_FALSE(shares_vertices(*points));
}

}  // namespace
}  // namespace curvecast
