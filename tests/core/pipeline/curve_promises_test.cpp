// What the curve promises whoever samples it (paper, section 3.2), on random demands and on real meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/random.h"
#include "core/density/face_density.h"
#include "core/pipeline/pipeline.h"
#include "tests/core/curve/charts.h"
#include "tests/support/real_mesh.h"

namespace curvecast {
namespace {

/// Demands all over the place: most of them small, some of them large, as a wild density would have it.
std::vector<double> random_demand(const Chart& chart, std::uint64_t seed) {
  std::vector<double> demand;
  for (std::size_t t = 0; t < chart.disc.face_count(); ++t) {
    const double wild = std::exp2(16 * std::pow(random_unit(seed, t), 6));
    demand.push_back(random_unit(seed + 1, t) < 0.1 ? 0 : 50 * wild);
  }
  return demand;
}

void expect_curve(const QuadtreeLeaves& leaves) {
  for (std::size_t l = 1; l < leaves.size(); ++l) {
    const Quad a = leaves.quad(l - 1), b = leaves.quad(l);
    const double touch_x = std::min(a.corner.x() + a.side, b.corner.x() + b.side) - std::max(a.corner.x(), b.corner.x());
    const double touch_y = std::min(a.corner.y() + a.side, b.corner.y() + b.side) - std::max(a.corner.y(), b.corner.y());
    ASSERT_EQ(std::min(touch_x, touch_y), 0) << "leaf " << l;  // a common piece of a side
    ASSERT_GT(std::max(touch_x, touch_y), 0) << "leaf " << l;
  }
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    const Quad said = leaves.quad(l), meant = leaf_quad(leaves.key[l], leaves.level[l]);
    ASSERT_EQ(said.corner, meant.corner);
    ASSERT_EQ(said.side, meant.side);
  }
}

/// Without gaps and overlaps each point of the square lies in exactly one leaf.
void expect_tiling(const QuadtreeLeaves& leaves) {
  std::uint64_t expected = 0;
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    ASSERT_EQ(leaves.key[l], expected);
    expected += std::uint64_t{1} << 2 * (kMaxLevel - leaves.level[l]);
  }
  EXPECT_EQ(expected, std::uint64_t{1} << 2 * kMaxLevel);
}

/// Each triangle t meets at least demand[t] leaves for each unit of its uv area, that is omega N_t of them.
void expect_enough(std::span<const ParameterTriangle> triangles, std::span<const double> demand, const QuadtreeLeaves& leaves) {
  std::vector<std::uint32_t> met(triangles.size(), 0);
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    for (const std::uint32_t t : leaves.triangles_of(l)) {
      ++met[t];
      // v_quad >= v_t / (A_p / A_quad): what the leaf's own vertex is enough for.
      const Quad quad = leaves.quad(l);
      ASSERT_GE(1, demand[t] * quad.side * quad.side) << "leaf " << l << ", triangle " << t;
    }
  }
  for (std::size_t t = 0; t < met.size(); ++t) {
    ASSERT_GE(met[t], demand[t] * triangles[t].uv_area() * (1 - 1e-9)) << "triangle " << t;
  }
}

TEST(CurvePromises, HoldForRandomDemands) {
  using namespace testing;
  for (const PolygonSoup& soup : {disc(8, 24), jittered(sphere(24, 30), 0.02), torus(24, 12), open_cylinder(20, 12, 5),
                                  perforated_slab(5, 3), single_triangle(), icosphere(4)}) {
    for (const Chart& chart : charts_of(make_mesh(soup))) {
      for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const std::vector<double> demand = random_demand(chart, 10 * seed);
        const Column<ParameterTriangle> triangles = parameter_triangles(chart);
        const absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(triangles, demand, 100'000'000);
        ASSERT_TRUE(leaves.ok());
        expect_curve(*leaves);
        expect_tiling(*leaves);
        expect_enough(triangles, demand, *leaves);
      }
    }
  }
}

TEST(CurvePromises, HoldAroundOneTriangleThatWantsMuchMore) {
  Chart chart = testing::grid_chart(40, [](const Vec2d& uv) { return Vec3d(uv.x(), uv.y(), 0); });
  std::vector<double> demand(chart.disc.face_count(), 1.0);
  const Column<ParameterTriangle> triangles = parameter_triangles(chart);
  demand[777] = std::ldexp(1.0, 22);
  const absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(triangles, demand, 100'000'000);
  ASSERT_TRUE(leaves.ok());
  expect_curve(*leaves);
  expect_tiling(*leaves);
  expect_enough(triangles, demand, *leaves);
  EXPECT_EQ(*std::max_element(leaves->level.begin(), leaves->level.end()), 11);
}

class RealCurve : public ::testing::TestWithParam<const char*> {};

TEST_P(RealCurve, HasEnoughVerticesForEveryTriangleAndTheSurfacesArea) {
  const testing::RealMesh file = testing::real_mesh(GetParam());
  for (const std::vector<DensityTerm>& density : {std::vector<DensityTerm>{}, {CurvatureTerm{}}}) {
    const PreprocessOptions options{.points = 65'536, .density = density};
    const absl::StatusOr<Preprocessed> done = preprocess({file.name, file.bytes}, options);
    ASSERT_TRUE(done.ok()) << done.status();
    EXPECT_LT(done->report.area_error, 1e-9);
    EXPECT_GE(done->curve->size(), 655'360u);
    const FlattenedMesh& flattened = *done->flattened;
    const absl::StatusOr<std::vector<double>> wanted =
        face_demand(flattened.loaded.mesh, flattened.geometry, flattened.loaded.attributes.scalars, density, 655'360);
    ASSERT_TRUE(wanted.ok());
    double sum = 0;
    for (std::size_t d = 0; d < flattened.charts.size(); ++d) {
      const Chart& chart = flattened.charts[d];
      std::vector<double> demand(chart.disc.face_count());
      const Column<ParameterTriangle> triangles = parameter_triangles(chart);
      for (std::size_t t = 0; t < demand.size(); ++t) demand[t] = (*wanted)[chart.disc.face_of[t]] * triangles[t].area_ratio;
      const absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(triangles, demand, 100'000'000);
      ASSERT_TRUE(leaves.ok());
      // It is the curve that preprocessing made.
      ASSERT_EQ(leaves->size(), done->curve->disc_begin[d + 1] - done->curve->disc_begin[d]);
      ASSERT_TRUE(std::equal(leaves->key.begin(), leaves->key.end(), done->curve->key.begin() + done->curve->disc_begin[d]));
      expect_curve(*leaves);
      expect_tiling(*leaves);
      expect_enough(triangles, demand, *leaves);
      std::vector<float> area(leaves->size());
      sum += area_elements(triangles, *leaves, area);
    }
    EXPECT_NEAR(sum, flattened.loaded.info.area, 1e-9 * sum);
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, RealCurve, ::testing::ValuesIn(testing::real_mesh_names()));

}  // namespace
}  // namespace curvecast
