#include "core/sample/move_apart.h"

#include <absl/status/statusor.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/memory_claim.h"
#include "core/base/work_limit.h"
#include "core/measure/ball_discrepancy.h"
#include "core/measure/spacing.h"
#include "core/pipeline/curve_surface.h"
#include "core/sample/resample.h"
#include "core/sample/splat_radius.h"
#include "core/sample/spread_in_leaves.h"
#include "tests/support/counting_source.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

struct Sampled {
  Preprocessed done;
  std::shared_ptr<const CurveBase> base;
  PointSet points;

  const TriangleMesh& mesh() const { return done.flattened->loaded.mesh; }
  double area() const { return done.flattened->report.mesh.area; }
};

Sampled sample(const PolygonSoup& soup, std::uint64_t n, const Density& density = {}) {
  const std::string off = to_off(soup);
  absl::StatusOr<Preprocessed> done = preprocess({"shape.off", off}, {.points = n});
  EXPECT_TRUE(done.ok()) << done.status();
  Sampled out{*std::move(done), {}, {}};
  absl::StatusOr<std::shared_ptr<const CurveBase>> base = curve_base(out.done.flattened);
  EXPECT_TRUE(base.ok()) << base.status();
  out.base = *std::move(base);
  absl::StatusOr<PointSet> points = resample(*out.done.curve, {.points = n, .density = density});
  EXPECT_TRUE(points.ok()) << points.status();
  out.points = *std::move(points);
  find_places(*out.done.curve, out.points);
  spread_in_leaves(*leaf_surface(out.done), out.points);
  return out;
}

std::vector<Vec3d> positions_of(const PointSet& points) {
  std::vector<Vec3d> positions;
  for (const Vec3f& p : points.positions) positions.emplace_back(points.origin + p.cast<double>());
  return positions;
}

/// The distance of neighbours in the densest packing.
double spacing_of(const PointSet& points, std::size_t i) {
  return std::sqrt(2 / std::sqrt(3.0) * SplatRadius::area_of_point(points.radii[i]));
}

double rho(const Sampled& sampled, const PointSet& points) {
  const std::vector<Vec3d> positions = positions_of(points);
  return neighbour_distances(sampled.area(), PointCloud(positions, bounding_box(sampled.mesh()))).min;
}

TEST(MoveApart, MakesBlueNoise) {
  for (const PolygonSoup& soup : {icosphere(4), torus(80, 40)}) {
    const Sampled before = sample(soup, 8'192);
    PointSet after = before.points;
    ASSERT_TRUE(move_apart(*before.base, 3, after).ok());
    EXPECT_LT(rho(before, before.points), 0.2);
    EXPECT_GT(rho(before, after), 0.75);
  }
}

TEST(MoveApart, KeepsTheSetAsEvenAtLarge) {
  // No point goes farther than kMostMove, so a ball's share changes by what crosses its border only, both ways.
  const Sampled before = sample(torus(80, 40), 8'192);
  PointSet after = before.points;
  ASSERT_TRUE(move_apart(*before.base, 20, after).ok());
  double farthest = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const double moved = (after.positions[i] - before.points.positions[i]).cast<double>().norm();
    farthest = std::max(farthest, moved / spacing_of(after, i));
  }
  EXPECT_LT(farthest, kMostMove + 0.01);  // positions of curve vertices are those of 16-bit weights
  EXPECT_GT(farthest, 0.3);
  const BallDiscrepancy balls(before.mesh(), {.centres = 256});
  EXPECT_LT(balls.of(positions_of(after)).rms, 1.05 * balls.of(positions_of(before.points)).rms);
}

TEST(MoveApart, PutsPointsWhereTheirPlacesSay) {
  const Sampled before = sample(jittered(torus(40, 20), 0.02), 3'000);
  PointSet after = before.points;
  ASSERT_TRUE(move_apart(*before.base, 5, after).ok());
  EXPECT_TRUE(after.has_moved);
  EXPECT_FALSE(before.points.has_moved);
  EXPECT_EQ(after.radii, before.points.radii);
  EXPECT_EQ(after.vertices, before.points.vertices);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const FacePlace& at = after.places[i];
    const Triangle& t = before.mesh().triangles[at.face];
    const double w1 = static_cast<double>(at.weight_1), w2 = static_cast<double>(at.weight_2);
    ASSERT_TRUE(w1 >= 0 && w2 >= 0 && w1 + w2 <= 1 + 1e-6);
    const std::vector<Vec3d>& p = before.mesh().positions;
    const Vec3d there = (1 - w1 - w2) * p[t[0]] + w1 * p[t[1]] + w2 * p[t[2]];
    ASSERT_LT((after.origin + after.positions[i].cast<double>() - there).norm(), 1e-6);
    ASSERT_NEAR(after.normals[i].norm(), 1, 1e-4);
  }
}

TEST(MoveApart, KeepsTheDensity) {
  // Sixteen times as dense on one half of a square as on the other.
  const Density density{ExpressionTerm{"1 + 15 * (x > 0.5)"}};
  const Sampled before = sample(square(30), 8'192, density);
  PointSet after = before.points;
  ASSERT_TRUE(move_apart(*before.base, 10, after).ok());
  const auto dense = [](const PointSet& points) {
    return std::count_if(points.positions.begin(), points.positions.end(), [](const Vec3f& p) { return p.x() > 0.5F; });
  };
  const auto expected = static_cast<double>(dense(before.points));
  EXPECT_NEAR(expected, 16.0 / 17 * 8'192, 30);
  // What crosses the line at which the density jumps: a row of some 115 dense points, or a part of it.
  EXPECT_NEAR(static_cast<double>(dense(after)), expected, 115);
  double nearest = 1e9;
  for (std::size_t i = 0; i < after.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto distance = static_cast<double>((after.positions[i] - after.positions[j]).norm());
      nearest = std::min(nearest, distance / std::min(spacing_of(after, i), spacing_of(after, j)));
    }
  }
  EXPECT_GT(nearest, 0.75);  // of the spacing that the density has there
}

TEST(MoveApart, LeavesBordersAsDenseAsTheRest) {
  for (const int n :
       {1, 10}) {  // with 1 the borders' edges are as long as the square, their middles far from what is beside them
    SCOPED_TRACE(n);
    const Sampled before = sample(square(n), 8'192);
    PointSet after = before.points;
    ASSERT_TRUE(move_apart(*before.base, 10, after).ok());
    const double spacing = spacing_of(after, 0);
    std::size_t on_border = 0, beside = 0;
    for (const Vec3f& p : after.positions) {
      const float from = std::min({p.x(), p.y(), 1 - p.x(), 1 - p.y()});
      on_border += from < 1e-4F;
      beside += static_cast<double>(from) < spacing;
    }
    EXPECT_LE(on_border, 2u);  // pressed into a corner
    const double share = 4 * spacing * (1 - spacing);
    EXPECT_NEAR(static_cast<double>(beside) / 8'192, share, 0.12 * share);
  }
}

TEST(MoveApart, SidesOfASheetAreAlone) {
  // Two squares that face away from each other, much nearer than their points are.
  PolygonSoup lower = square(8);
  for (std::size_t i = 0; i < lower.indices.size(); i += 3) std::swap(lower.indices[i], lower.indices[i + 1]);
  const Sampled both = sample(merged(lower, translated(square(8), {0, 0, 0.001})), 4'096);
  PointSet after = both.points;
  ASSERT_TRUE(move_apart(*both.base, 10, after).ok());
  std::vector<Vec3d> sides[2];
  for (const Vec3d& p : positions_of(after)) sides[p.z() > 0.0005].push_back(p);
  for (const std::vector<Vec3d>& side : sides) {
    EXPECT_NEAR(static_cast<double>(side.size()), 2'048, 8);
    EXPECT_GT(neighbour_distances(1, PointCloud(side, bounding_box(both.mesh()))).min, 0.55);
  }
}

TEST(MoveApart, IsTheSameForAnyNumberOfThreads) {
  const Sampled before = sample(torus(60, 30), 5'000);
  PointSet sets[2] = {before.points, before.points};
  for (const int threads : {1, 4}) {
    tbb::task_arena(threads).execute([&] { ASSERT_TRUE(move_apart(*before.base, 6, sets[threads / 4]).ok()); });
  }
  EXPECT_EQ(sets[0].positions, sets[1].positions);
  EXPECT_EQ(sets[0].normals, sets[1].normals);
}

TEST(MoveApart, LeavesPointsWhereNothingIsToBeDone) {
  const Sampled before = sample(icosphere(2), 100);
  PointSet after = before.points;
  ASSERT_TRUE(move_apart(*before.base, 0, after).ok());
  EXPECT_EQ(after.positions, before.points.positions);
  EXPECT_FALSE(after.has_moved);
  const Sampled one = sample(icosphere(2), 1);
  PointSet alone = one.points;
  ASSERT_TRUE(move_apart(*one.base, 5, alone).ok());
  EXPECT_EQ(alone.positions, one.points.positions);
}

TEST(MoveApart, EndsWhereItMayNotGoOn) {
  const Sampled before = sample(icosphere(3), 2'000);
  PointSet points = before.points;
  const std::atomic<bool> cancel = true;
  EXPECT_TRUE(absl::IsCancelled(move_apart(*before.base, 5, points, {.cancel = &cancel})));
  points = before.points;
  WorkLimit limit(WorkLimit::Nanoseconds(1));
  EXPECT_TRUE(absl::IsDeadlineExceeded(move_apart(*before.base, 5, points, {.limit = &limit})));
  points = before.points;
  for (const auto& [bytes, why] : {std::pair(1'000, "finding the neighbours of 1280 triangles takes"),
                                   std::pair(100'000, "moving 2000 points apart on 1280 triangles takes")}) {
    CountingSource memory(static_cast<std::uint64_t>(bytes));
    const absl::Status refused = move_apart(*before.base, 5, points, {.memory = &memory});
    EXPECT_TRUE(absl::IsResourceExhausted(refused));
    EXPECT_NE(refused.message().find(why), std::string::npos) << refused;
  }
  CountingSource enough;
  ASSERT_TRUE(move_apart(*before.base, 5, points, {.memory = &enough}).ok());
  EXPECT_EQ(enough.taken(), 0u);
  EXPECT_GT(enough.peak(), 100'000u);
}

}  // namespace
}  // namespace curvecast
