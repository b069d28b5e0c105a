#include "core/progressive/progressive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/measure/ball_discrepancy.h"
#include "core/measure/coverage.h"
#include "core/measure/spacing.h"
#include "core/mesh_io/mesh_io.h"
#include "core/pipeline/curve_surface.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/flat_curve.h"
#include "tests/support/real_mesh.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// A shape with the curve on it.
struct Surface {
  TriangleMesh mesh;
  std::shared_ptr<const SurfaceCurve> curve;
  std::shared_ptr<const LeafSurface> leaves;
};

Surface surface_of(std::string_view name, std::string_view bytes, std::uint64_t points) {
  const PreprocessOptions options{.points = points};
  absl::StatusOr<Preprocessed> done = preprocess({name, bytes}, options);
  EXPECT_TRUE(done.ok()) << done.status();
  if (!done.ok()) return {};
  return {done->flattened->loaded.mesh, done->curve, leaf_surface(*done)};
}

Surface surface_of(const PolygonSoup& soup, std::uint64_t points) { return surface_of("shape.off", to_off(soup), points); }

ProgressiveRanks ranks_of(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options,
                          const ExecutionContext& context = {}) {
  absl::StatusOr<ProgressiveRanks> ranks = ProgressiveRanks::make(std::move(surface), options, context);
  EXPECT_TRUE(ranks.ok()) << ranks.status();
  return *std::move(ranks);
}

bool same(std::span<const RankedPoint> a, std::span<const RankedPoint> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

/// The points of the lowest ranks.
struct Prefix {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;
};

Prefix prefix_of(const ProgressiveRanks& ranks, std::size_t n) {
  Prefix prefix{std::vector<Vec3d>(n), std::vector<Vec3f>(n)};
  for (const RankedPoint& p : ranks.points()) {
    if (p.rank >= n) continue;
    prefix.positions[p.rank] = ranks.curve().origin + Vec3d(p.position[0], p.position[1], p.position[2]);
    prefix.normals[p.rank] = Vec3f(p.normal[0], p.normal[1], p.normal[2]);
  }
  return prefix;
}

/// Off the powers of four and on them: together even, apart, without holes.
void expect_even_prefixes(const Surface& surface, int level) {
  const ProgressiveRanks ranks = ranks_of(surface.leaves, {.level = level});
  const double area = surface.curve->total_area;
  const BallDiscrepancy balls(surface.mesh);
  for (std::size_t n = 1024; n <= ranks.points().size(); n = n * 5 / 4) {
    const Prefix prefix = prefix_of(ranks, n);
    const PointCloud cloud(prefix.positions, surface.curve->box);
    EXPECT_GE(neighbour_distances_on_side(area, cloud, prefix.normals).min, 0.48) << n;
    EXPECT_LE(coverage_radius(surface.mesh, cloud) / packing_radius(area, n), 2.4) << n;
    // N^(-3/4): over random points a quarter power.
    EXPECT_LE(balls.of(prefix.positions).rms_relative * std::pow(static_cast<double>(n), 0.25), 1.36) << n;
  }
}

const Surface& ball() {
  static const Surface surface = surface_of(icosphere(4), 16'384);
  return surface;
}

TEST(ProgressiveRanks, EveryStratumOfEveryLevelHasOnePointOfThePrefix) {
  constexpr int kLevel = 6;
  const ProgressiveRanks ranks = ranks_of(ball().leaves, {.level = kLevel});
  ASSERT_EQ(ranks.points().size(), 4096u);
  std::vector<int> times(4096, 0);
  for (const RankedPoint& p : ranks.points()) ++times[p.rank];
  EXPECT_TRUE(std::all_of(times.begin(), times.end(), [](int t) { return t == 1; }));
  for (int l = 0; l <= kLevel; ++l) {
    const std::size_t strata = std::size_t{1} << 2 * l;
    std::vector<int> held(strata, 0);
    for (std::size_t i = 0; i < 4096; ++i) {
      if (ranks.points()[i].rank < strata) ++held[i * strata / 4096];
    }
    EXPECT_TRUE(std::all_of(held.begin(), held.end(), [](int h) { return h == 1; })) << l;
  }
}

TEST(ProgressiveRanks, DoNotDependOnThreads) {
  const ProgressiveRanks one = ranks_of(ball().leaves, {.level = 6}, {.threads = 1});
  for (const int threads : {2, 3, 8}) {
    EXPECT_TRUE(same(one.points(), ranks_of(ball().leaves, {.level = 6}, {.threads = threads}).points())) << threads;
  }
  EXPECT_FALSE(same(one.points(), ranks_of(ball().leaves, {.level = 6, .seed = 1}).points()));
}

TEST(ProgressiveRanks, ADeeperLevelKeepsAllRanks) {
  const ProgressiveRanks coarse = ranks_of(ball().leaves, {.level = 4}), fine = ranks_of(ball().leaves, {.level = 6});
  std::vector<RankedPoint> kept;
  for (const RankedPoint& p : fine.points()) {
    if (p.rank < 256) kept.push_back(p);
  }
  EXPECT_TRUE(same(kept, coarse.points()));
}

TEST(ProgressiveRanks, PartsAreWhatTheWholeWouldBe) {
  constexpr int kDeep = 7;
  const ProgressiveRanks whole = ranks_of(ball().leaves, {.level = kDeep});
  for (const int level : {0, 2, 4, 5, 7}) {
    const ProgressiveRanks ranks = ranks_of(ball().leaves, {.level = level});
    DeepGroups made;
    const std::uint64_t strata = ranks.points().size(), part = whole.points().size() / strata;
    for (const std::uint64_t first : {std::uint64_t{0}, strata / 3, strata - 1}) {
      const std::uint64_t last = std::min(strata, first + 1 + first % 2);
      const auto points = ranks.deepen(kDeep, std::vector<StrataRange>{{first * part, last * part}}, made);
      ASSERT_TRUE(points.ok()) << points.status();
      EXPECT_TRUE(same(*points, whole.points().subspan(first * part, (last - first) * part))) << level << ' ' << first;
    }
    const auto none = ranks.deepen(kDeep, std::vector<StrataRange>{{strata * part, strata * part}}, made);
    EXPECT_TRUE(none.ok() && none->empty());
    const auto both = ranks.deepen(kDeep, std::vector<StrataRange>{{4000, 4900}, {100, 333}}, made);
    ASSERT_TRUE(both.ok()) << both.status();
    EXPECT_TRUE(same(std::span(*both).first(900), whole.points().subspan(4000, 900)));
    EXPECT_TRUE(same(std::span(*both).subspan(900), whole.points().subspan(100, 233)));
  }
}

TEST(ProgressiveRanks, WhatIsExtendedIsWhatTheWholeWouldBe) {
  const ProgressiveRanks whole = ranks_of(ball().leaves, {.level = 7, .seed = 3});
  ProgressiveRanks ranks = ranks_of(ball().leaves, {.level = 2, .seed = 3});
  for (const int level : {3, 6, 7}) {
    ASSERT_TRUE(ranks.extend(level).ok());
    EXPECT_EQ(ranks.level(), level);
  }
  EXPECT_TRUE(same(ranks.points(), whole.points()));
  EXPECT_EQ(ranks.extend(7).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ranks.extend(12).code(), absl::StatusCode::kInvalidArgument);
}

TEST(ProgressiveRanks, ZoomingInNeverRunsOut) {
  const ProgressiveRanks ranks = ranks_of(flat_surface(flat_curve(5)), {.level = 4});
  DeepGroups made;
  for (int level = 5; level <= kMaxRankLevel; ++level) {
    const std::uint64_t first = std::uint64_t{77} << 2 * (level - 4);
    const auto points = ranks.deepen(level, std::vector<StrataRange>{{first, first + 500}}, made);
    ASSERT_TRUE(points.ok()) << points.status();
    for (std::size_t i = 0; i < points->size(); ++i) EXPECT_EQ((*points)[i].curve_position >> (64 - 2 * level), first + i);
  }
}

TEST(ProgressiveRanks, PrefixesAreEvenOnShapes) {
  expect_even_prefixes(ball(), 7);
  expect_even_prefixes(surface_of(torus(24, 48), 16'384), 7);
  expect_even_prefixes(surface_of(merged(icosphere(3), translated(icosphere(3, 0.5), {3, 0, 0})), 16'384), 7);
}

TEST(ProgressiveRanks, PrefixesAreEvenOnRealMeshes) {
  for (const char* name : {"spot.obj", "rocker-arm.obj", "chinese-lion.obj"}) {
    const testing::RealMesh file = testing::real_mesh(name);
    SCOPED_TRACE(file.name);
    expect_even_prefixes(surface_of(file.name, file.bytes, 16'384), 7);
  }
}

TEST(ProgressiveRanks, TheCurveMayBeCoarserThanThePoints) {
  const Surface coarse = surface_of(icosphere(4), 1000);
  expect_even_prefixes(coarse, 6);
}

TEST(ProgressiveRanks, RefusesWhatCannotBe) {
  for (const int level : {-1, 12}) {
    EXPECT_EQ(ProgressiveRanks::make(ball().leaves, {.level = level}).status().code(), absl::StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(ProgressiveRanks::make(flat_surface(std::make_shared<SurfaceCurve>()), {}).status().code(),
            absl::StatusCode::kInvalidArgument);
  for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    auto curve = flat_curve(3);
    curve->area[5] = bad;
    EXPECT_EQ(ProgressiveRanks::make(flat_surface(curve), {.level = 2}).status().code(), absl::StatusCode::kInvalidArgument);
  }
  const ProgressiveRanks ranks = ranks_of(ball().leaves, {.level = 3});
  DeepGroups made;
  for (const auto& [level, first, last] :
       {std::tuple{2, 0u, 1u}, {21, 0u, 1u}, {4, 2u, 1u}, {4, 0u, 257u}, {15, 0u, 4'000'001u}}) {
    EXPECT_EQ(ranks.deepen(level, std::vector<StrataRange>{{first, last}}, made).status().code(),
              absl::StatusCode::kInvalidArgument)
        << level;
  }
}

TEST(ProgressiveRanks, CanBeCancelled) {
  const std::atomic<bool> cancel = true;
  ExecutionContext context;
  context.cancel = &cancel;
  EXPECT_EQ(ProgressiveRanks::make(ball().leaves, {.level = 4}, context).status().code(), absl::StatusCode::kCancelled);
  const ProgressiveRanks ranks = ranks_of(ball().leaves, {.level = 3});
  DeepGroups made;
  EXPECT_EQ(ranks.deepen(5, std::vector<StrataRange>{{0, 64}}, made, context).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
