#include "core/density/fixed_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace curvecast {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Places along the x axis.
SurfaceCurve row(const std::vector<float>& x, const Vec3d& origin = Vec3d::Zero()) {
  SurfaceCurve curve;
  curve.resize(x.size());
  curve.origin = origin;
  for (std::size_t l = 0; l < x.size(); ++l) {
    curve.x[l] = x[l];
    curve.y[l] = curve.z[l] = 0;
    curve.nx[l] = curve.ny[l] = 0.0f, curve.nz[l] = 1.0f;
    curve.curvature_min[l] = curve.curvature_max[l] = 0.0f;
    curve.area[l] = 1;
  }
  return curve;
}

void give(SurfaceCurve& curve, const std::string& name, const std::vector<float>& values) {
  ScalarColumn& column = curve.scalars.emplace_back();
  column.name = name;
  column.values.resize(values.size());
  std::copy(values.begin(), values.end(), column.values.begin());
}

std::vector<float> values_of(const SurfaceCurve& curve, const DensityTerm& term) {
  std::vector<float> density(curve.size(), 1.0f);
  const absl::Status status = multiply_fixed_term(curve, term, density);
  EXPECT_TRUE(status.ok()) << status;
  return density;
}

std::string refusal(const SurfaceCurve& curve, const DensityTerm& term) {
  std::vector<float> density(curve.size(), 1.0f);
  const absl::Status status = multiply_fixed_term(curve, term, density);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  return std::string(status.message());
}

TEST(FixedTerms, OfAnAttributeAreItsPositiveValues) {
  SurfaceCurve curve = row({0, 1, 2, 3, 4});
  give(curve, "other", {1, 1, 1, 1, 1});
  give(curve, "heat", {2, 0, -1, kNaN, 4});
  EXPECT_THAT(values_of(curve, AttributeTerm{"heat"}), ElementsAre(0.5f, 0.0f, 0.0f, 0.0f, 1.0f));
}

TEST(FixedTerms, OfAnAttributeAreOneAtTheirLargestWhateverTheirSize) {
  for (const float size : {1e-44f, 1e-30f, 3e38f}) {
    SurfaceCurve curve = row({0, 1});
    give(curve, "heat", {size, 0});
    EXPECT_THAT(values_of(curve, AttributeTerm{"heat"}), ElementsAre(1.0f, 0.0f)) << size;
  }
  SurfaceCurve curve = row({0, 1});
  give(curve, "heat", {0, -1});
  EXPECT_THAT(values_of(curve, AttributeTerm{"heat"}), ElementsAre(0.0f, 0.0f));
}

TEST(FixedTerms, OfAnAttributeSayWhatThereIsAndWhereItIsInfinite) {
  SurfaceCurve curve = row({0, 1.5f}, Vec3d(10, 20, 30));
  EXPECT_THAT(refusal(curve, AttributeTerm{"heat"}), HasSubstr("none"));
  give(curve, "cold", {1, 2});
  give(curve, "heat", {1, kInfinity});
  EXPECT_THAT(refusal(curve, AttributeTerm{"wet"}), HasSubstr("no attribute 'wet'; there are: cold, heat"));
  EXPECT_THAT(refusal(curve, AttributeTerm{"heat"}), HasSubstr("infinite at 11.5, 20, 30"));
}

TEST(FixedTerms, OfABrushRiseSmoothlyFromItsFactorToOne) {
  const Vec3d origin(100, 200, 300);
  std::vector<float> x;
  for (int i = 0; i <= 40; ++i) x.push_back(0.1f * static_cast<float>(i));
  const SurfaceCurve curve = row(x, origin);
  for (const double factor : {0.0, 0.25, 4.0, 1e6}) {
    for (const double falloff : {0.0, 0.5, 1.0}) {
      const std::vector<float> values = values_of(curve, BrushTerm{{{origin, 2, factor, falloff}}});
      const double outside = values.back(), unit = outside;
      ASSERT_GT(unit, 0);
      for (std::size_t l = 0; l < x.size(); ++l) {
        const double value = values[l] / unit, distance = x[l];
        if (distance >= 2.001) {
          EXPECT_NEAR(value, 1, 1e-6);
        }
        if (distance <= 2 * (1 - falloff) - 0.001) {
          EXPECT_NEAR(value, factor, 1e-6 * factor);
        }
        ASSERT_LE(values[l], 1);
        if (factor > 1) {
          ASSERT_LE(value, factor * (1 + 1e-6));
        }
        if (l > 0) {
          EXPECT_GE((values[l] - values[l - 1]) * (factor < 1 ? 1 : -1), 0) << "rises or falls only";
        }
      }
      if (falloff == 1.0) {
        EXPECT_NEAR(values[10] / unit, 1 + 0.5 * (factor - 1), 1e-5 * (1 + factor));
      }
    }
  }
  EXPECT_EQ(values_of(curve, BrushTerm{{{origin, 1, 0}}})[0], 0) << "factor 0 erases";
}

TEST(FixedTerms, OfAnExpressionAreItsPositiveValues) {
  const SurfaceCurve curve = row({-1, 0, 1, 4});
  EXPECT_THAT(values_of(curve, ExpressionTerm{"x"}), ElementsAre(0.0f, 0.0f, 0.25f, 1.0f));
  EXPECT_THAT(values_of(curve, ExpressionTerm{"sqrt(x)"}), ElementsAre(0.0f, 0.0f, 0.5f, 1.0f)) << "NaN counts as 0";
  EXPECT_THAT(refusal(curve, ExpressionTerm{"1 / x"}), HasSubstr("infinite at 0, 0, 0"));
}

TEST(FixedTerms, LeaveOtherTermsAlone) {
  const SurfaceCurve curve = row({0, 1});
  for (const DensityTerm& term :
       std::vector<DensityTerm>{UniformTerm{}, ViewTerm{}, ScreenTerm{}, DistanceTerm{}, FrustumTerm{}}) {
    EXPECT_THAT(values_of(curve, term), ElementsAre(1.0f, 1.0f));
  }
}

}  // namespace
}  // namespace curvecast
