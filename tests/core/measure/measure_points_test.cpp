#include "core/measure/measure_points.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "core/measure/random_surface_points.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/resample.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using Sets = std::vector<std::vector<Vec3d>>;

TriangleMesh torus() { return testing::make_mesh(testing::torus(30, 20)); }

std::vector<Vec3d> random(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed) {
  return random_surface_points(mesh, n, seed).positions;
}

/// The product's own points on a mesh.
std::vector<Vec3d> sampled(const PolygonSoup& soup, const ResampleOptions& options) {
  const auto done = preprocess({"shape.off", testing::to_off(soup)}, {.points = 20'000});
  EXPECT_TRUE(done.ok()) << done.status();
  const auto set = resample(*done->curve, options);
  EXPECT_TRUE(set.ok()) << set.status();
  std::vector<Vec3d> points;
  for (const Vec3f& p : set->positions) points.push_back(set->origin + p.cast<double>());
  return points;
}

TEST(MeasurePoints, TellsRandomPointsFromEvenOnes) {
  const PolygonSoup soup = testing::torus(30, 20);
  const TriangleMesh mesh = testing::make_mesh(soup);
  Sets sets;
  for (const std::size_t n : {500u, 2000u, 8000u}) sets.push_back(random(mesh, n, n));
  const auto noise = measure_points(mesh, sets, {});
  ASSERT_TRUE(noise.ok()) << noise.status();
  for (std::vector<Vec3d>& set : sets) set = sampled(soup, {.points = set.size()});
  const auto even = measure_points(mesh, sets, {});
  ASSERT_TRUE(even.ok()) << even.status();
  for (std::size_t s = 0; s < 3; ++s) {
    const PointMeasures &a = noise->sets[s], &b = even->sets[s];
    EXPECT_EQ(a.points, sets[s].size());
    EXPECT_LT(a.surface_max, 1e-12);
    EXPECT_LT(b.surface_max, 1e-6);
    EXPECT_LE(b.surface_mean, b.surface_max);
    EXPECT_LT(b.ball.rms_relative, 0.5 * a.ball.rms_relative);
    EXPECT_LT(b.ring.rms_relative, 0.5 * a.ring.rms_relative);
    EXPECT_GT(b.spacing.mean, a.spacing.mean);
    EXPECT_LT(b.coverage, a.coverage);
    EXPECT_GT(b.coverage, 1);
  }
  ASSERT_TRUE(noise->gradient && even->gradient);
  EXPECT_NEAR(noise->gradient->ball_rms, -0.5, 0.2);
  EXPECT_NEAR(even->gradient->ball_rms, -0.75, 0.12);
  EXPECT_LT(even->gradient->ring_rms, -0.6);
}

TEST(MeasurePoints, ComparesWithTheDensityAskedFor) {
  const PolygonSoup soup = testing::torus(60, 40);
  const std::vector<DensityTerm> density = {CurvatureTerm{}};
  const Sets sets = {sampled(soup, {.points = 5000, .density = density})};
  const TriangleMesh mesh = testing::make_mesh(soup);
  const auto with = measure_points(mesh, sets, {.density = density}), without = measure_points(mesh, sets, {});
  ASSERT_TRUE(with.ok() && without.ok());
  EXPECT_LT(with->sets[0].ball.rms_relative, 0.35);
  EXPECT_LT(with->sets[0].ring.rms_relative, 0.35);
  EXPECT_GT(without->sets[0].ball.rms_relative, 3 * with->sets[0].ball.rms_relative);
}

TEST(MeasurePoints, OffTheSurfaceAreMeasuredWhereTheyAreNearest) {
  const TriangleMesh mesh = testing::make_mesh(testing::square(10));
  std::vector<Vec3d> points = random(mesh, 100, 1);
  points[7].z() = 0.5;
  const auto found = measure_points(mesh, Sets{points}, {});
  ASSERT_TRUE(found.ok());
  EXPECT_NEAR(found->sets[0].surface_max, 0.5, 1e-12);
  EXPECT_NEAR(found->sets[0].surface_mean, 0.005, 1e-12);
  EXPECT_FALSE(found->gradient);
}

TEST(MeasurePoints, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = torus();
  const Sets sets = {random(mesh, 300, 1), random(mesh, 900, 2)};
  ExecutionContext one, four;
  one.threads = 1;
  four.threads = 4;
  const auto a = measure_points(mesh, sets, {.seed = 3}, one), b = measure_points(mesh, sets, {.seed = 3}, four);
  ASSERT_TRUE(a.ok() && b.ok());
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(a->sets[s].ring.rms, b->sets[s].ring.rms);
    EXPECT_EQ(a->sets[s].ball.rms, b->sets[s].ball.rms);
    EXPECT_EQ(a->sets[s].spacing_on_side.mean, b->sets[s].spacing_on_side.mean);
    EXPECT_EQ(a->sets[s].coverage, b->sets[s].coverage);
  }
  EXPECT_NE(a->sets[0].ball.rms, measure_points(mesh, sets, {.seed = 4})->sets[0].ball.rms);
}

TEST(MeasurePoints, RefusesWhatCannotBeMeasured) {
  const TriangleMesh mesh = torus();
  const auto refused = [&](const Sets& sets, const MeasureOptions& options, absl::StatusCode code, const std::string& words) {
    const absl::Status status = measure_points(mesh, sets, options).status();
    EXPECT_EQ(status.code(), code) << status;
    EXPECT_NE(status.message().find(words), std::string::npos) << status;
  };
  const Sets good = {random(mesh, 10, 1)};
  Sets bad = {good[0], good[0]};
  bad[1][3].y() = std::numeric_limits<double>::quiet_NaN();
  using Code = absl::StatusCode;
  refused({}, {}, Code::kInvalidArgument, "no set");
  refused({good[0], {Vec3d(1, 0, 0)}}, {}, Code::kInvalidArgument, "set 1 has too few points, 1");
  refused(bad, {}, Code::kInvalidArgument, "point 3 of set 1 is not finite");
  bad[1][3] = Vec3d(0, 1e8, 0);
  refused(bad, {}, Code::kInvalidArgument, "point 3 of set 1 is farther");
  refused(good, {.ring_seeds = 0}, Code::kInvalidArgument, "ring_seeds = 0");
  refused(good, {.ball_centres = kMaxRegions + 1}, Code::kInvalidArgument, "ball_centres");
  refused(good, {.density = {CurvatureTerm{.floor = 2}}}, Code::kInvalidArgument, "floor");
  refused(good, {.density = {BrushTerm{{Dab{.radius = 1e9}}}}}, Code::kFailedPrecondition, "zero");
}

TEST(MeasurePoints, StopsWhenToldTo) {
  const TriangleMesh mesh = torus();
  const Sets sets(5, random(mesh, 1000, 1));
  for (const std::string at : {"balls", "points", "rings"}) {
    std::atomic<bool> cancel = false;
    ExecutionContext context;
    context.cancel = &cancel;
    context.on_progress = [&](std::string_view stage, double /*fraction*/) { cancel = cancel || stage == at; };
    EXPECT_EQ(measure_points(mesh, sets, {}, context).status().code(), absl::StatusCode::kCancelled) << at;
  }
}

}  // namespace
}  // namespace curvecast
