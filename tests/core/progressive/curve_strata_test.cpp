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
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
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
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  for (const std::size_t n : {1u, 50u, 5000u}) {
    std::vector<double> t(n);
    for (std::size_t i = 0; i < n; ++i) t[i] = (static_cast<double>(i) + random_unit(2, i)) / static_cast<double>(n);
    std::vector<CurvePoint> points(n);
    strata.points_at(t, 1.0 / static_cast<double>(t.size()), points);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(points[i].vertex, strata.vertex_at(t[i]));
      const Vec3f p(points[i].position[0], points[i].position[1], points[i].position[2]);
      EXPECT_LE((p - curve->position(points[i].vertex)).lpNorm<Eigen::Infinity>(), 1 / 32.0f + 1e-6f);
    }
  }
}

TEST(CurveStrata, ManyPointsFillTheLeaf) {
  const auto curve = flat_curve(2);
  const auto surface = flat_surface(curve);
  const CurveStrata strata(*surface);
  std::vector<double> t(4096);
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = (static_cast<double>(i) + 0.5) / 4096;
  std::vector<CurvePoint> points(t.size());
  strata.points_at(t, 1.0 / static_cast<double>(t.size()), points);
  std::vector<int> in_cell(4096);
  for (const CurvePoint& point : points) {
    ++in_cell[static_cast<std::size_t>(point.position[0] * 64) + 64 * static_cast<std::size_t>(point.position[1] * 64)];
  }
  for (const int count : in_cell) EXPECT_EQ(count, 1);
}

TEST(CurveStrata, PointsSpreadOverAStratumLieInIt) {
  const auto surface = flat_surface(flat_curve(3));
  const CurveStrata strata(*surface);
  for (const int level : {2, 5}) {
    const auto side = static_cast<float>(std::ldexp(1.0, -level));
    for (std::uint64_t stratum = 0; stratum < 16; ++stratum) {
      const HilbertCell cell = hilbert_cell(stratum, level);
      const Vec3f corner(static_cast<float>(cell.x) * side, static_cast<float>(cell.y) * side, 0);
      const std::vector<CurvePoint> points = strata.spread_over(level, stratum, 64);
      Eigen::AlignedBox3f box;
      for (const CurvePoint& p : points) box.extend(Vec3f(p.position[0], p.position[1], p.position[2]));
      EXPECT_TRUE(Eigen::AlignedBox3f(corner, corner + Vec3f(side, side, 0)).contains(box)) << level << ' ' << stratum;
      EXPECT_GE(box.sizes().head<2>().minCoeff(), 0.86f * side);
    }
  }
}

TEST(CurveStrata, PointsInSmallLeavesHavePlacesOfTheirOwnWhereTheyAreToHave) {
  const auto surface = flat_surface(flat_curve(3));
  const CurveStrata strata(*surface);
  const std::vector<double> t = {0.5001, 0.5002, 0.5003, 0.9};
  std::vector<CurvePoint> points(t.size());
  strata.points_at(t, 1, points);
  EXPECT_EQ(points[0].position[0], points[1].position[0]) << "at the leaf's vertex";
  strata.points_at(t, 1, points, PointPlaces::kOnSurface);
  for (std::size_t i = 0; i < t.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GT(std::hypot(points[i].position[0] - points[j].position[0], points[i].position[1] - points[j].position[1]), 1e-4);
    }
  }
}

TEST(CurveStrata, PointsLieAboutWhereTheyLieOnAFlatSurface) {
  const auto surface = flat_surface(flat_curve(5));
  const CurveStrata strata(*surface);
  std::vector<double> t;
  for (int i = 0; i < 200; ++i) t.push_back((i + 0.3) / 200);
  std::vector<CurvePoint> about(t.size()), on_surface(t.size());
  strata.points_at(t, 0x1p-9, about, PointPlaces::kAbout);  // two leaves are a grain
  strata.points_at(t, 0x1p-9, on_surface, PointPlaces::kOnSurface);
  for (std::size_t i = 0; i < t.size(); ++i) {
    EXPECT_EQ(about[i].face, kNone);
    EXPECT_NE(on_surface[i].face, kNone);
    EXPECT_EQ(about[i].vertex, on_surface[i].vertex);
    EXPECT_NEAR(about[i].position[0], on_surface[i].position[0], 0x1p-8);
    EXPECT_NEAR(about[i].position[1], on_surface[i].position[1], 0x1p-8);
  }
  strata.points_at(t, 0x1p-11, about, PointPlaces::kAbout);  // half a leaf
  strata.points_at(t, 0x1p-11, on_surface, PointPlaces::kOnSurface);
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_EQ(about[i].face, on_surface[i].face) << "exact in larger leaves";
}

}  // namespace
}  // namespace curvecast
