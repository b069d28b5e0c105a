#include "core/progressive/curve_strata.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// With leaves of all sizes, some of them without area.
std::shared_ptr<SurfaceCurve> uneven_curve() {
  auto curve = flat_curve(4);
  for (std::size_t l = 0; l < curve->size(); ++l) curve->area[l] = l % 7 == 3 ? 0 : static_cast<float>(random_unit(1, l));
  return curve;
}

TEST(CurveStrata, FindTheVertexByArea) {
  const auto curve = uneven_curve();
  const CurveStrata strata(*curve);
  double before = 0;
  for (std::size_t l = 0; l < curve->size(); ++l) {
    const double area = static_cast<double>(curve->area[l]);
    if (area > 0) {
      EXPECT_EQ(strata.vertex_at((before + 0.001 * area) / strata.total_area()), l);
      EXPECT_EQ(strata.vertex_at((before + 0.999 * area) / strata.total_area()), l);
    }
    before += area;
  }
  EXPECT_EQ(strata.total_area(), before);
  EXPECT_EQ(strata.vertex_at(0), 0u);
  EXPECT_LT(strata.vertex_at(1), curve->size());
}

TEST(CurveStrata, PointsAreInTheLeavesOfTheirVertices) {
  const auto curve = uneven_curve();
  const CurveStrata strata(*curve);
  for (const std::size_t n : {1u, 50u, 5000u}) {
    std::vector<double> t(n);
    for (std::size_t i = 0; i < n; ++i) t[i] = (static_cast<double>(i) + random_unit(2, i)) / static_cast<double>(n);
    std::vector<CurvePoint> points(n);
    strata.points_at(t, points);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(points[i].vertex, strata.vertex_at(t[i]));
      const Vec3f p(points[i].position[0], points[i].position[1], points[i].position[2]);
      EXPECT_LE((p - curve->position(points[i].vertex)).lpNorm<Eigen::Infinity>(), 1 / 32.0f + 1e-6f);
    }
  }
}

TEST(CurveStrata, ManyPointsFillTheLeaf) {
  const auto curve = flat_curve(2);
  const CurveStrata strata(*curve);
  std::vector<double> t(4096);
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = (static_cast<double>(i) + 0.5) / 4096;
  std::vector<CurvePoint> points(t.size());
  strata.points_at(t, points);
  std::vector<int> in_cell(4096);
  for (const CurvePoint& point : points) {
    ++in_cell[static_cast<std::size_t>(point.position[0] * 64) + 64 * static_cast<std::size_t>(point.position[1] * 64)];
  }
  for (const int count : in_cell) EXPECT_EQ(count, 1);
}

TEST(CurveStrata, BoxesHoldTheLeaves) {
  const auto curve = flat_curve(5);
  const CurveStrata strata(*curve);
  for (std::uint64_t stratum = 0; stratum < 16; ++stratum) {
    const Eigen::AlignedBox3f box = strata.box(2, stratum);
    const HilbertCell cell = hilbert_cell(stratum, 2);
    const Vec3f corner(static_cast<float>(cell.x) / 4, static_cast<float>(cell.y) / 4, 0);
    EXPECT_TRUE(box.contains(corner));
    EXPECT_TRUE(box.contains(Vec3f(corner + Vec3f(0.25f, 0.25f, 0))));
    EXPECT_LT(box.sizes().head<2>().maxCoeff(), 0.33f);
  }
}

}  // namespace
}  // namespace curvecast
