#include "core/curve/curvature_measure.h"

#include <gtest/gtest.h>

#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

TEST(CurvatureMeasure, CombinesThePrincipalCurvatures) {
  EXPECT_FLOAT_EQ(curvature_measure(CurvatureKind::kGauss, -3, 2), 6);
  EXPECT_FLOAT_EQ(curvature_measure(CurvatureKind::kMean, -3, 2), 0.5);
  EXPECT_FLOAT_EQ(curvature_measure(CurvatureKind::kMax, -3, 2), 3);
}

SurfaceCurve ramp() {
  SurfaceCurve curve;
  curve.resize(1000);
  curve.box.extend({0, 0, 0});
  curve.box.extend({1, 1, 1});
  curve.total_area = 1000;
  for (int l = 0; l < 1000; ++l) {
    curve.curvature_min[l] = curve.curvature_max[l] = static_cast<float>(l + 1) / 1000;
    curve.area[l] = 1;
  }
  return curve;
}

TEST(ReferenceCurvatures, ATwentiethOfTheAreaIsCurvedMore) {
  const auto reference = reference_curvatures(ramp());
  EXPECT_NEAR(reference[static_cast<int>(CurvatureKind::kMean)], 0.95, 0.02);
  EXPECT_NEAR(reference[static_cast<int>(CurvatureKind::kMax)], 0.95, 0.02);
  EXPECT_NEAR(reference[static_cast<int>(CurvatureKind::kGauss)], 0.95 * 0.95, 0.02);
}

TEST(ReferenceCurvatures, CountByArea) {
  SurfaceCurve curve = ramp();
  for (int l = 500; l < 1000; ++l) curve.area[l] = 0;
  curve.total_area = 500;
  EXPECT_NEAR(reference_curvatures(curve)[static_cast<int>(CurvatureKind::kMean)], 0.475, 0.01);
}

TEST(ReferenceCurvatures, NoiseOnAFlatSurfaceCountsAsNone) {
  SurfaceCurve curve = ramp();
  for (Bfloat16& k : curve.curvature_min) k = 1e-7f * k;
  curve.curvature_max = curve.curvature_min;
  for (const float k : reference_curvatures(curve)) EXPECT_EQ(k, 0);
}

}  // namespace
}  // namespace curvecast
