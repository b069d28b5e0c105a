#include "core/density/density.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "tests/core/density/sphere_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using testing::seen_from;
using testing::sphere_curve;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<float> density_of(const SurfaceCurve& curve, const Density& terms) {
  std::vector<float> density(curve.size(), -1.0f);
  const absl::Status status = evaluate_density(curve, terms, density);
  EXPECT_TRUE(status.ok()) << status;
  return density;
}

void expect_refused(const DensityTerm& term, const std::string& name, const std::string& field) {
  const SurfaceCurve curve = sphere_curve(10);
  std::vector<float> density(curve.size());
  // A good term before it does not hide it.
  const absl::Status status = evaluate_density(curve, seen_from(Vec3d::Zero(), {UniformTerm{}, term}), density);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr(name));
  EXPECT_THAT(std::string(status.message()), HasSubstr(field));
}

TEST(Density, IsOneWithoutTermsOrUniform) {
  const SurfaceCurve curve = sphere_curve();
  EXPECT_THAT(density_of(curve, {}), Each(1.0f));
  EXPECT_THAT(density_of(curve, {UniformTerm{}, UniformTerm{}}), Each(1.0f));
}

TEST(Density, OfCurvatureFollowsItsDefinition) {
  const SurfaceCurve curve = sphere_curve(5000, 0.01);
  for (const CurvatureKind kind : {CurvatureKind::kGauss, CurvatureKind::kMean, CurvatureKind::kMax}) {
    const double reference = curve.reference_curvature[static_cast<std::size_t>(kind)];
    ASSERT_GT(reference, 0);
    for (const double exponent : {0.0, 0.5, 1.0, 3.0}) {
      for (const double floor : {0.0, 0.05, 0.7, 1.0}) {
        const std::vector<float> density = density_of(curve, {CurvatureTerm{.kind = kind, .exponent = exponent, .floor = floor}});
        for (std::size_t l = 0; l < curve.size(); ++l) {
          const double k1 = curve.curvature_min[l], k2 = curve.curvature_max[l];
          const double k = kind == CurvatureKind::kGauss  ? std::abs(k1 * k2)
                           : kind == CurvatureKind::kMean ? std::abs(k1 + k2) / 2
                                                          : std::max(std::abs(k1), std::abs(k2));
          const double expected = std::pow(floor + (1 - floor) * std::min(k / reference, 1.0), exponent);
          ASSERT_NEAR(density[l], expected, 1e-5) << "vertex " << l;
          ASSERT_GE(density[l], std::pow(floor, exponent) * (1 - 1e-6));
          ASSERT_LE(density[l], 1);
        }
      }
    }
  }
}

TEST(Density, OfCurvatureIsOneOnATwentiethOfTheArea) {
  const SurfaceCurve curve = sphere_curve(100'000);
  for (const CurvatureKind kind : {CurvatureKind::kGauss, CurvatureKind::kMean, CurvatureKind::kMax}) {
    const std::vector<float> density = density_of(curve, {CurvatureTerm{.kind = kind}});
    const auto full = static_cast<double>(std::count(density.begin(), density.end(), 1.0f));
    EXPECT_NEAR(full / static_cast<double>(curve.size()), 0.05, 0.01);
  }
}

TEST(Density, OfCurvatureIsUniformWithExponentZeroOrOnFlatSurfaces) {
  SurfaceCurve curve = sphere_curve();
  EXPECT_THAT(density_of(curve, {CurvatureTerm{.exponent = 0, .floor = 0}}), Each(1.0f));
  // Flat but for rounding noise.
  for (std::size_t l = 0; l < curve.size(); ++l) {
    curve.curvature_min[l] = static_cast<float>(1e-7 * (random_unit(1, l) - 0.5));
    curve.curvature_max[l] = static_cast<float>(1e-7 * random_unit(2, l));
  }
  curve.reference_curvature = reference_curvatures(curve);
  for (const CurvatureKind kind : {CurvatureKind::kGauss, CurvatureKind::kMean, CurvatureKind::kMax}) {
    EXPECT_THAT(density_of(curve, {CurvatureTerm{.kind = kind, .exponent = 2}}), Each(1.0f));
  }
}

TEST(Density, OfSeveralTermsIsTheirProduct) {
  const SurfaceCurve curve = sphere_curve();
  const std::vector<DensityTerm> terms = {CurvatureTerm{.kind = CurvatureKind::kMax, .exponent = 0.7}, ViewTerm{}, UniformTerm{},
                                          CurvatureTerm{.floor = 0.2}};
  std::vector<double> product(curve.size(), 1.0);
  for (const DensityTerm& term : terms) {
    const std::vector<float> one = density_of(curve, seen_from(Vec3d(1, 2, 3), {term}));
    for (std::size_t l = 0; l < curve.size(); ++l) product[l] *= one[l];
  }
  std::vector<DensityTerm> reversed(terms.rbegin(), terms.rend());
  for (const auto& order : {terms, reversed}) {
    const std::vector<float> density = density_of(curve, seen_from(Vec3d(1, 2, 3), order));
    for (std::size_t l = 0; l < curve.size(); ++l) ASSERT_NEAR(density[l], product[l], 1e-6 * product[l]) << "vertex " << l;
  }
}

TEST(Density, RefusesBadValuesByName) {
  for (const double bad : {-1.0, kNaN, kInfinity}) expect_refused(CurvatureTerm{.exponent = bad}, "curvature", "exponent");
  for (const double bad : {-0.01, 1.01, kNaN, kInfinity}) expect_refused(CurvatureTerm{.floor = bad}, "curvature", "floor");
  for (const double bad : {0.0, -0.1, kNaN, kInfinity}) expect_refused(ViewTerm{.s0 = bad}, "view", "s0");
  for (const double bad : {-1.0, kNaN, kInfinity}) expect_refused(DistanceTerm{.near = bad}, "distance", "near");
  for (const double bad : {0.0, 1.0, kNaN, -kInfinity}) expect_refused(DistanceTerm{.near = 2, .far = bad}, "distance", "far");
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) expect_refused(BrushTerm{{Dab{.radius = bad}}}, "brush", "radius");
  for (const double bad : {-1.0, 1e7, kNaN, kInfinity}) expect_refused(BrushTerm{{Dab{.factor = bad}}}, "brush", "factor");
  for (const double bad : {-0.1, 1.1, kNaN, kInfinity}) expect_refused(BrushTerm{{Dab{.falloff = bad}}}, "brush", "falloff");
  for (const double bad : {kNaN, kInfinity}) expect_refused(BrushTerm{{Dab{.centre = Vec3d(0, bad, 0)}}}, "brush", "centre");
  expect_refused(AttributeTerm{}, "attribute", "name is empty");
  expect_refused(ExpressionTerm{"1 +"}, "expression", "1 +");
}

TEST(Density, NeedsGoodCamerasForTheirTerms) {
  const SurfaceCurve curve = sphere_curve(10);
  std::vector<float> values(curve.size());
  for (const DensityTerm& term : std::vector<DensityTerm>{ViewTerm{}, DistanceTerm{}, FrustumTerm{}, ScreenTerm{}}) {
    EXPECT_TRUE(is_camera_term(term));
    const absl::Status status = evaluate_density(curve, {term}, values);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr("camera"));
    EXPECT_FALSE(has_fixed_terms(std::vector<DensityTerm>{term, UniformTerm{}}));
  }
  EXPECT_TRUE(has_fixed_terms(std::vector<DensityTerm>{BrushTerm{}}));
  Density density = seen_from(Vec3d(0, 0, 3));
  density.cameras.resize(kMaxCameras, density.cameras[0]);
  EXPECT_TRUE(evaluate_density(curve, density, values).ok());
  density.cameras[3].fov = 0;
  EXPECT_THAT(std::string(evaluate_density(curve, density, values).message()), HasSubstr("camera 3 of the density: fov"));
  density.cameras.resize(kMaxCameras + 1, density.cameras[0]);
  EXPECT_THAT(std::string(evaluate_density(curve, density, values).message()), HasSubstr("17 cameras; at most 16"));
}

TEST(Density, IsFiniteForHugeValuesOrRefusesThem) {
  const SurfaceCurve curve = sphere_curve(500);
  std::vector<float> density(curve.size());
  for (const double huge : {1e30, 1e39, 1e300}) {
    const Density view = seen_from(Vec3d(0, 0, 3), {ViewTerm{.s0 = huge}});
    if (const absl::Status status = evaluate_density(curve, view, density); status.ok()) {
      for (const float d : density) ASSERT_TRUE(std::isfinite(d)) << huge;
    } else {
      EXPECT_THAT(std::string(status.message()), HasSubstr("s0"));
    }
    for (const float d : density_of(curve, {CurvatureTerm{.exponent = huge}})) ASSERT_TRUE(d >= 0 && d <= 1) << huge;
  }
}

}  // namespace
}  // namespace curvecast
