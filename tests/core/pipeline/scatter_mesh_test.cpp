#include "core/pipeline/scatter_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

LoadedMesh load(const PolygonSoup& soup) {
  absl::StatusOr<LoadedMesh> loaded = load_mesh(soup, "shape");
  EXPECT_TRUE(loaded.ok()) << loaded.status();
  return *std::move(loaded);
}

ScatteredPoints scatter_on(const PolygonSoup& soup, const MeshScatter& wanted, int threads = 0) {
  absl::StatusOr<ScatteredPoints> points = scatter_mesh(load(soup), wanted, {.threads = threads});
  EXPECT_TRUE(points.ok()) << points.status();
  return points.ok() ? *std::move(points) : ScatteredPoints();
}

/// How far points are from where their polygons and weights say, at most. All polygons are triangles.
double distance_from_places(const PolygonSoup& soup, const PointSet& points) {
  double most = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [face, u, v] = points.places[i];
    const auto corner = [&](std::size_t k) { return soup.positions[soup.indices[3 * face + k]]; };
    const Vec3d place =
        corner(0) + static_cast<double>(u) * (corner(1) - corner(0)) + static_cast<double>(v) * (corner(2) - corner(0));
    most = std::max(most, (points.origin + points.positions[i].cast<double>() - place).norm());
  }
  return most;
}

/// A ball among faces without an area, which repair drops, with the height of its vertices.
PolygonSoup untidy_ball() {
  PolygonSoup soup = curvecast::testing::icosphere(3);
  ScalarAttribute& height = soup.attributes.scalars.emplace_back();
  height.name = "height";
  for (const Vec3d& p : soup.positions) height.values.push_back(static_cast<float>(p.z()));
  const PolygonSoup ball = soup;
  soup.indices.clear();
  soup.polygon_begin = {0};
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    soup.indices.insert(soup.indices.end(), {a, b, c});
    soup.polygon_begin.push_back(soup.indices.size());
  };
  for (std::size_t f = 0; f < ball.polygon_count(); ++f) {
    if (f % 3 == 0) add(ball.indices[3 * f], ball.indices[3 * f], ball.indices[3 * f + 1]);
    add(ball.indices[3 * f + 1], ball.indices[3 * f + 2], ball.indices[3 * f]);
  }
  return soup;
}

TEST(ScatterMesh, TellsAllThatIsWanted) {
  const PolygonSoup soup = untidy_ball();
  for (const int rounds : {0, 2}) {
    const ScatteredPoints scattered =
        scatter_on(soup, {.points = 3000, .seed = 4, .rounds = rounds, .curvatures = true, .directions = true, .scalars = true});
    const PointSet& points = scattered.points;
    ASSERT_EQ(points.size(), 3000u);
    EXPECT_LT(distance_from_places(soup, points), 1e-6);
    ASSERT_EQ(scattered.curvatures.size(), 6000u);
    ASSERT_EQ(scattered.directions.size(), 9000u);
    ASSERT_EQ(scattered.scalars.size(), 1u);
    EXPECT_EQ(scattered.scalars[0].first, "height");
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d position = points.origin + points.positions[i].cast<double>();
      EXPECT_NEAR(scattered.scalars[0].second[i], position.z(), 1e-5);
      EXPECT_NEAR(scattered.curvatures[2 * i], 1, 0.1);
      const Vec3f direction(scattered.directions[3 * i], scattered.directions[3 * i + 1], scattered.directions[3 * i + 2]);
      EXPECT_NEAR(direction.dot(points.normals[i]), 0, 1e-4);
    }
  }
  const ScatteredPoints ranked = scatter_on(soup, {.points = 300, .seed = 1, .ranks = true});
  std::vector<std::uint32_t> ranks = ranked.points.ranks;
  std::sort(ranks.begin(), ranks.end());
  for (std::uint32_t i = 0; i < 300; ++i) ASSERT_EQ(ranks.at(i), i);
  const ScatteredPoints plain = scatter_on(soup, {.points = 10});
  EXPECT_TRUE(plain.points.ranks.empty());
  EXPECT_TRUE(plain.curvatures.empty() && plain.directions.empty() && plain.scalars.empty());
}

TEST(ScatterMesh, IsTheSameForAnyNumberOfThreads) {
  const PolygonSoup soup = untidy_ball();
  MeshScatter wanted = {.points = 5000, .seed = 9, .rounds = 1, .scalars = true};
  wanted.density.terms = {CurvatureTerm{}, ExpressionTerm{"height + 1.1"}};
  const ScatteredPoints one = scatter_on(soup, wanted, 1), four = scatter_on(soup, wanted, 4);
  EXPECT_EQ(one.points.positions, four.points.positions);
  EXPECT_EQ(one.scalars, four.scalars);
}

TEST(ScatterMesh, CreasesAreWhereTheCallerSays) {
  // Of a cube all points of a face have its normal; of one without creases those near edges lean over.
  const auto upright = [](std::optional<double> degrees) {
    const ScatteredPoints cube = scatter_on(curvecast::testing::cube(), {.points = 2000, .crease_degrees = degrees});
    return std::count_if(cube.points.normals.begin(), cube.points.normals.end(),
                         [](const Vec3f& n) { return n.cwiseAbs().maxCoeff() > 0.9999f; });
  };
  EXPECT_EQ(upright(std::nullopt), 2000);
  EXPECT_EQ(upright(89.0), 2000);
  EXPECT_LT(upright(180.0), 100);
}

TEST(ScatterMesh, AGlobalDistanceLeavesFewerPoints) {
  MeshScatter wanted = {.points = 4000};
  wanted.density.terms = {DistanceTerm{.near = 2, .global = true}};
  wanted.density.cameras = {Camera{.eye = {0, 0, 8}}};
  const std::size_t fewer = scatter_on(curvecast::testing::icosphere(3), wanted).points.size();
  EXPECT_GT(fewer, 10u);
  EXPECT_LT(fewer, 2000u);
}

TEST(ScatterMesh, SaysWhatIsWrong) {
  const auto error_of = [](const MeshScatter& wanted) { return scatter_mesh(load(curvecast::testing::cube()), wanted).status(); };
  EXPECT_EQ(error_of({.points = 0}).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(error_of({.points = kMaxPoints + 1}).code(), absl::StatusCode::kOutOfRange);
  for (const double degrees : {-1.0, 180.5, std::numeric_limits<double>::quiet_NaN()}) {
    const absl::Status status = error_of({.points = 10, .crease_degrees = degrees});
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr("crease_degrees"));
  }
  MeshScatter none = {.points = 10};
  none.density.terms = {AttributeTerm{.name = "weight"}};
  EXPECT_THAT(std::string(error_of(none).message()), HasSubstr("weight"));
}

TEST(ScatterMesh, EndsWhenItIsCancelled) {
  std::atomic<bool> cancel = false;
  ExecutionContext context{.cancel = &cancel};
  context.on_progress = [&](std::string_view stage, double /*fraction*/) { cancel = stage == "scatter"; };
  const auto status = scatter_mesh(load(untidy_ball()), {.points = 100'000, .rounds = 100}, context).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
}

TEST(ScatterMesh, WorkIsLimited) {
  WorkLimit limit(std::chrono::milliseconds(1));
  const auto status = scatter_mesh(load(untidy_ball()), {.points = 50'000, .rounds = 100}, {.limit = &limit}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded);
}

}  // namespace
}  // namespace curvecast
