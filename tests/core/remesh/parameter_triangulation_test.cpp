#include "core/remesh/parameter_triangulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/flatten/flatten.h"
#include "core/measure/hausdorff.h"
#include "core/remesh/remesh.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

class ParameterTriangulation : public ::testing::TestWithParam<std::size_t> {
 protected:
  static absl::StatusOr<Remeshed> remeshed(const TriangleMesh& surface, std::size_t n, int relaxations, std::size_t chart_faces,
                                           RemeshMethod method = RemeshMethod::kParameter) {
    FlattenTimes times;
    const auto charts = flatten(surface, {.most_whole_faces = chart_faces, .chart_faces = chart_faces}, {}, times);
    if (!charts.ok()) return charts.status();
    const std::vector<ChartView> views(charts->begin(), charts->end());
    return remesh(surface, random_places(surface, n), {.relaxations = relaxations, .method = method}, {}, views);
  }
};

TEST_P(ParameterTriangulation, KeepsNumbersAndTopologyOrSaysWhatItLacks) {
  int made_some = 0;
  for (const auto& [name, shape] : remesh_shapes()) {
    for (const std::size_t n : {300u, 3'000u}) {
      SCOPED_TRACE(name + ", " + std::to_string(n));
      for (const int relaxations : {0, 3}) {
        const auto made = remeshed(shape, n, relaxations, GetParam());
        if (!made.ok()) {
          EXPECT_EQ(made.status().code(), absl::StatusCode::kInvalidArgument) << made.status();
          continue;
        }
        ++made_some;
        EXPECT_EQ(made->mesh.vertex_count(), n);
        expect_same_topology(made->mesh, shape);
        std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
        for (std::uint32_t h = 0; h < made->mesh.twins.size(); ++h) sides.emplace_back(made->mesh.from(h), made->mesh.to(h));
        std::sort(sides.begin(), sides.end());
        EXPECT_EQ(std::adjacent_find(sides.begin(), sides.end()), sides.end()) << "two edges between the same vertices";
      }
    }
  }
  EXPECT_GT(made_some, 20);
}

TEST_P(ParameterTriangulation, LiesAsNearToTheSurfaceAsTheOtherMethodOnceRelaxed) {
  for (const TriangleMesh& surface : {make_mesh(icosphere(5)), make_mesh(torus(80, 60))}) {
    const auto square = remeshed(surface, 3'000, 5, GetParam());
    const auto own = remeshed(surface, 3'000, 5, GetParam(), RemeshMethod::kSurface);
    ASSERT_TRUE(square.ok()) << square.status();
    ASSERT_TRUE(own.ok()) << own.status();
    const double rms = hausdorff_distance(surface, square->mesh, {.samples = 100'000}).forward.rms;
    EXPECT_LT(rms, 1.3 * hausdorff_distance(surface, own->mesh, {.samples = 100'000}).forward.rms);
  }
}

TEST_P(ParameterTriangulation, IsTheSameEveryTime) {
  const TriangleMesh surface = make_mesh(jittered(torus(40, 24), 0.01));
  const auto one = remeshed(surface, 1'000, 2, GetParam()), other = remeshed(surface, 1'000, 2, GetParam());
  ASSERT_TRUE(one.ok()) << one.status();
  EXPECT_EQ(one->mesh.positions, other->mesh.positions);
  EXPECT_EQ(one->mesh.triangles, other->mesh.triangles);
}

INSTANTIATE_TEST_SUITE_P(InOneChartAndInSeveral, ParameterTriangulation, ::testing::Values(1'000'000u, 1'000u));

TEST(RemeshInParameter, TakesNoFeatures) {
  const TriangleMesh ball = make_mesh(icosphere(3));
  const auto made = remesh(ball, random_places(ball, 100), {.feature_degrees = 30, .method = RemeshMethod::kParameter}, {}, {});
  EXPECT_EQ(made.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(made.status().message()), ::testing::HasSubstr("features"));
}

}  // namespace
}  // namespace curvecast
