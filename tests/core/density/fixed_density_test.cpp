#include "core/density/fixed_density.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

/// A flat curve that says that it is bent.
std::shared_ptr<SurfaceCurve> bent_curve() {
  auto curve = testing::flat_curve(4);
  for (std::size_t l = 0; l < curve->size(); ++l) {
    curve->curvature_min[l] = 0.5f;
    curve->curvature_max[l] = static_cast<float>(l % 7);
  }
  curve->reference_curvature = {2, 2, 2};
  return curve;
}

TEST(FixedDensity, IsTheProductOfTheTermsThatNoCameraChanges) {
  const auto curve = bent_curve();
  const CurvatureTerm bends{.kind = CurvatureKind::kGauss};
  const std::vector<DensityTerm> terms = {ViewTerm{}, bends, UniformTerm{}};
  const auto fixed = make_fixed_density(*curve, terms);
  ASSERT_TRUE(fixed.ok()) << fixed.status();
  std::vector<float> expected(curve->size());
  ASSERT_TRUE(evaluate_density(*curve, {bends}, expected).ok());
  EXPECT_EQ((*fixed)->density, Column<float>(expected));
  double total = 0;
  for (std::size_t l = 0; l < curve->size(); ++l) total += static_cast<double>(expected[l] * curve->area[l]);
  EXPECT_NEAR((*fixed)->mass.total / total, 1, 1e-6);
  ASSERT_EQ((*fixed)->most.size(), curve->size() / kBlockSize);
  for (std::size_t l = 0; l < curve->size(); ++l) EXPECT_LE(expected[l], (*fixed)->most[l / kBlockSize]);
  EXPECT_EQ((*fixed)->most[3], *std::max_element(&expected[3 * kBlockSize], &expected[4 * kBlockSize]));
  EXPECT_GT((*fixed)->byte_size(), curve->size() * sizeof(float));
}

TEST(FixedDensity, IsNoneWithoutSuchTerms) {
  const auto curve = bent_curve();
  for (const std::vector<DensityTerm>& terms : {std::vector<DensityTerm>{}, {UniformTerm{}, ViewTerm{}}}) {
    const auto fixed = make_fixed_density(*curve, terms);
    ASSERT_TRUE(fixed.ok()) << fixed.status();
    EXPECT_EQ(*fixed, nullptr);
  }
  const std::vector<DensityTerm> bad = {AttributeTerm{"none"}};
  EXPECT_TRUE(absl::IsInvalidArgument(make_fixed_density(*curve, bad).status()));
}

}  // namespace
}  // namespace curvecast
