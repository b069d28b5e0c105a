#include "core/refine/refine.h"

#include <gtest/gtest.h>

#include <atomic>

#include "core/sample/resample.h"
#include "tests/core/refine/refined.h"
#include "tests/support/real_mesh.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

RefinedCurve refined(const Refinable& shape, const SurfaceCurve& curve, const std::vector<CurveDemand>& demands,
                     const RefineOptions& options = {}, const ExecutionContext& context = {}) {
  const absl::StatusOr<RefinedCurve> out = refine(*shape.base, curve, demands, options, context);
  EXPECT_TRUE(out.ok()) << out.status();
  return out.ok() ? *out : RefinedCurve{};
}

float highest_load(const SurfaceCurve& curve, const CurveDemand& demand) {
  std::vector<float> load(curve.size(), 0);
  EXPECT_TRUE(raise_vertex_loads(curve, demand, 10, load).ok());
  return *std::max_element(load.begin(), load.end());
}

/// Refines until the curve is fine enough, as a server does that is asked again.
void expect_enough_in_a_few_rounds(const Refinable& shape, const CurveDemand& demand) {
  std::shared_ptr<const SurfaceCurve> curve = shape.done.curve;
  for (int round = 0; round < 4 && highest_load(*curve, demand) > kMaxVertexLoad; ++round) {
    const RefinedCurve finer = refined(shape, *curve, {demand});
    ASSERT_NE(finer.curve, nullptr);
    EXPECT_EQ(finer.curve->revision, curve->revision + 1);
    EXPECT_GT(finer.curve->size(), curve->size());
    expect_valid_curve(*finer.curve);
    EXPECT_EQ(finer.curve->blocks.size(), block_count(finer.curve->size()));
    curve = finer.curve;
  }
  EXPECT_LE(highest_load(*curve, demand), kMaxVertexLoad);
}

TEST(Refine, MakesTheCurveFineEnough) {
  for (const auto& shape : refinable_shapes()) {
    expect_enough_in_a_few_rounds(*shape, {.points = 3000});
    expect_enough_in_a_few_rounds(*shape, {.points = 4000, .density = seen_from(Vec3d(0.3, 0.4, 5))});
    expect_enough_in_a_few_rounds(*shape, {.points = 1000, .density = {CurvatureTerm{.exponent = 4, .floor = 0.01}}});
  }
}

TEST(Refine, AnEvenDemandThatIsAPowerOfFourRaisesAll) {
  const auto shape = refinable(icosphere(3));
  const std::uint64_t n = 16 * shape->curve().max_points;
  const RefinedCurve finer = refined(*shape, shape->curve(), {{.points = n}});
  ASSERT_NE(finer.curve, nullptr);
  EXPECT_EQ(finer.divisor, 1);
  EXPECT_EQ(finer.curve->size(), 16 * shape->curve().size());
  EXPECT_EQ(finer.curve->max_points, n);
}

TEST(Refine, ALocalDemandLeavesTheRestAlone) {
  const auto shape = refinable(icosphere(4), 2000);
  const SurfaceCurve& curve = shape->curve();
  // A brush by hand: all points within a small cap.
  std::vector<float> load(curve.size(), 0);
  for (std::size_t l = 0; l < curve.size(); ++l) load[l] = curve.z[l] > 0.98f ? 300.0f : 0.2f;
  const MissingLevels missing = missing_levels(curve, load, 100'000'000);
  EXPECT_EQ(missing.divisor, 1);
  std::size_t in_cap = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    EXPECT_EQ(missing.levels[l], curve.z[l] > 0.98f ? 5 : 0);
    in_cap += curve.z[l] > 0.98f;
  }
  // And by a view that comes very near: what is far off or turned away stays as it was.
  const CurveDemand near{.points = 20'000, .density = seen_from(Vec3d(0, 0, 1.02), {ViewTerm{.s0 = 0.01}})};
  const RefinedCurve finer = refined(*shape, curve, {near});
  ASSERT_NE(finer.curve, nullptr);
  expect_valid_curve(*finer.curve);
  std::size_t kept = 0;
  for_each_common(curve, *finer.curve, [&](std::size_t l, std::size_t m) {
    ++kept;
    EXPECT_TRUE(same_vertex(curve, l, *finer.curve, m));
    EXPECT_EQ(curve.area[l], finer.curve->area[m]);
  });
  EXPECT_GT(static_cast<double>(kept), 0.9 * static_cast<double>(curve.size()));
  EXPECT_GT(in_cap, 0u);
}

TEST(Refine, SeveralDemandsAreMetAtOnce) {
  const auto shape = refinable(icosphere(3));
  const CurveDemand left{.points = 8000, .density = seen_from(Vec3d(-4, 0, 0))};
  const CurveDemand right{.points = 8000, .density = seen_from(Vec3d(4, 0, 0))};
  const RefinedCurve both = refined(*shape, shape->curve(), {left, right});
  const RefinedCurve one = refined(*shape, shape->curve(), {left});
  ASSERT_TRUE(both.curve != nullptr && one.curve != nullptr);
  EXPECT_LE(highest_load(*both.curve, left), kMaxVertexLoad);
  EXPECT_LE(highest_load(*both.curve, right), kMaxVertexLoad);
  EXPECT_GT(both.curve->size(), one.curve->size());
}

TEST(Refine, GivesTheBestThatTheLimitAllows) {
  const auto shape = refinable(icosphere(3));
  const SurfaceCurve& curve = shape->curve();
  const CurveDemand demand{.points = 1'000'000, .density = seen_from(Vec3d(0, 0, 4))};
  const RefinedCurve finer = refined(*shape, curve, {demand}, {.max_vertices = 60'000, .max_points = 1'000'000});
  ASSERT_NE(finer.curve, nullptr);
  EXPECT_GT(finer.divisor, 1);
  EXPECT_LE(finer.curve->size(), 60'000u);
  EXPECT_GT(finer.curve->size(), 30'000u);
  EXPECT_EQ(finer.curve->max_points, curve.max_points);
  EXPECT_LT(highest_load(*finer.curve, demand), highest_load(curve, demand) / 4);
  // Nothing left to give.
  const RefinedCurve none = refined(*shape, curve, {demand}, {.max_vertices = curve.size()});
  EXPECT_EQ(none.curve, nullptr);
  EXPECT_GT(none.divisor, 1);
}

TEST(Refine, DoesNothingWhereNothingIsMissing) {
  const auto shape = refinable(icosphere(3));
  const RefinedCurve none = refined(*shape, shape->curve(), {{.points = shape->curve().max_points}});
  EXPECT_EQ(none.curve, nullptr);
  EXPECT_EQ(none.divisor, 1);
}

TEST(Refine, TheNumberOfThreadsChangesNothing) {
  const auto shape = refinable(torus(60, 30), 2000);
  for (const CurveDemand& demand :
       {CurveDemand{.points = 32'000}, CurveDemand{.points = 20'000, .density = seen_from(Vec3d(0, 0, 3))}}) {
    const RefinedCurve one = refined(*shape, shape->curve(), {demand}, {}, {.threads = 1});
    const RefinedCurve two = refined(*shape, shape->curve(), {demand}, {}, {.threads = 3});
    ASSERT_TRUE(one.curve != nullptr && two.curve != nullptr);
    ASSERT_EQ(one.curve->size(), two.curve->size());
    for (std::size_t l = 0; l < one.curve->size(); ++l) {
      ASSERT_TRUE(same_vertex(*one.curve, l, *two.curve, l));
      ASSERT_EQ(one.curve->area[l], two.curve->area[l]);
    }
  }
}

TEST(Refine, PointsCoincideNoMore) {
  const auto shape = refinable(icosphere(3));
  const std::uint64_t n = 30'000;  // 60 times what the curve was made for
  const auto distinct = [&](const SurfaceCurve& curve) {
    const absl::StatusOr<PointSet> points = resample(curve, {.points = n});
    EXPECT_TRUE(points.ok());
    std::vector<std::uint32_t> v = points->vertices;
    return static_cast<std::size_t>(std::unique(v.begin(), v.end()) - v.begin());
  };
  const RefinedCurve finer = refined(*shape, shape->curve(), {{.points = n}});
  ASSERT_NE(finer.curve, nullptr);
  EXPECT_LT(distinct(shape->curve()), n / 2);
  EXPECT_GT(distinct(*finer.curve), n - n / 10);
}

TEST(Refine, RefusesBadDemandsAndStopsWhenCancelled) {
  const auto shape = refinable(icosphere(2));
  const std::vector<CurveDemand> bad = {{.points = 10'000, .density = {CurvatureTerm{.exponent = -1}}}};
  EXPECT_EQ(refine(*shape->base, shape->curve(), bad, {}).status().code(), absl::StatusCode::kInvalidArgument);
  const std::atomic<bool> cancel = true;
  const std::vector<CurveDemand> good = {{.points = 10'000}};
  EXPECT_EQ(refine(*shape->base, shape->curve(), good, {}, {.cancel = &cancel}).status().code(), absl::StatusCode::kCancelled);
}

class RefineRealMesh : public ::testing::TestWithParam<const char*> {};

TEST_P(RefineRealMesh, MakesTheCurveFineEnough) {
  const testing::RealMesh file = testing::real_mesh(GetParam());
  const auto shape = refinable({file.name, file.bytes}, {.points = 5000});
  ASSERT_NE(shape, nullptr);
  expect_enough_in_a_few_rounds(*shape, {.points = 80'000});
  const Vec3d eye = shape->curve().box.center() + Vec3d(0.3, 0.4, 2) * shape->curve().box.diagonal();
  expect_enough_in_a_few_rounds(*shape, {.points = 60'000, .density = seen_from(eye, {ViewTerm{}, CurvatureTerm{}})});
}

INSTANTIATE_TEST_SUITE_P(Shared, RefineRealMesh,
                         ::testing::Values("3holes.off", "chinese-lion.obj", "fertility.off", "squirrel.obj", "teapot.obj"));

}  // namespace
}  // namespace curvecast
