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

#include "core/sample/random.h"

namespace curvecast {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A sphere of `n` curve vertices of equal area, with curvatures that have nothing to do with it: random, with flat places.
SurfaceCurve sphere_curve(std::size_t n = 5000, double radius = 1, const Vec3d& origin = Vec3d::Zero()) {
  SurfaceCurve curve;
  curve.resize(n);
  curve.disc_begin = {0, static_cast<std::uint32_t>(n)};
  curve.origin = origin;
  for (std::size_t l = 0; l < n; ++l) {
    const double z = 1 - (2 * static_cast<double>(l) + 1) / static_cast<double>(n);
    const double a = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(l);
    const Vec3d normal(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
    curve.x[l] = static_cast<float>(radius * normal.x());
    curve.y[l] = static_cast<float>(radius * normal.y());
    curve.z[l] = static_cast<float>(radius * normal.z());
    curve.nx[l] = static_cast<float>(normal.x());
    curve.ny[l] = static_cast<float>(normal.y());
    curve.nz[l] = static_cast<float>(normal.z());
    curve.area[l] = static_cast<float>(4 * std::numbers::pi * radius * radius / static_cast<double>(n));
    const double strong = l % 7 == 0 ? 0 : std::exp(4 * random_unit(3, l));
    curve.curvature_min[l] = static_cast<float>((random_unit(4, l) - 0.5) * strong / radius);
    curve.curvature_max[l] = static_cast<float>(strong / radius);
  }
  curve.total_area = 4 * std::numbers::pi * radius * radius;
  curve.box.extend(origin + Vec3d::Constant(radius));
  curve.box.extend(origin - Vec3d::Constant(radius));
  curve.max_points = n;
  curve.reference_curvature = reference_curvatures(curve);
  return curve;
}

std::vector<float> density_of(const SurfaceCurve& curve, const std::vector<DensityTerm>& terms) {
  std::vector<float> density(curve.size(), -1.0f);
  const absl::Status status = evaluate_density(curve, terms, density);
  EXPECT_TRUE(status.ok()) << status;
  return density;
}

void expect_refused(const DensityTerm& term, const std::string& name, const std::string& field) {
  const SurfaceCurve curve = sphere_curve(10);
  std::vector<float> density(curve.size());
  // A good term before it does not hide it.
  const absl::Status status = evaluate_density(curve, std::vector<DensityTerm>{UniformTerm{}, term}, density);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr(name));
  EXPECT_THAT(std::string(status.message()), HasSubstr(field));
}

/// Checks the view term against the definition, in double precision, for an eye at `eye`.
void expect_view(const SurfaceCurve& curve, const Vec3d& eye, double s0) {
  const std::vector<float> density = density_of(curve, {ViewTerm{.eye = eye, .s0 = s0}});
  std::size_t front = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const Vec3d place = curve.origin + Vec3d(curve.x[l], curve.y[l], curve.z[l]);
    const Vec3d normal(curve.nx[l], curve.ny[l], curve.nz[l]);
    const Vec3d towards = eye - place;
    const double cosine = (towards / towards.cwiseAbs().maxCoeff()).normalized().dot(normal);
    if (std::abs(cosine) < 1e-5) continue;  // either side of the silhouette
    if (cosine > 0) {
      ++front;
      ASSERT_NEAR(density[l], 1 - cosine + s0, 1e-5 * (1 + s0)) << "vertex " << l << ", eye " << eye.transpose();
    } else {
      ASSERT_EQ(density[l], 0.0f) << "vertex " << l << ", eye " << eye.transpose();
    }
  }
  EXPECT_GT(front, 0u) << "eye " << eye.transpose();
  EXPECT_LT(front, curve.size()) << "eye " << eye.transpose();
}

TEST(Density, IsOneWithoutTermsOrUniform) {
  const SurfaceCurve curve = sphere_curve();
  EXPECT_THAT(density_of(curve, {}), Each(1.0f));
  EXPECT_THAT(density_of(curve, {UniformTerm{}, UniformTerm{}}), Each(1.0f));
}

TEST(Density, OfAViewFollowsItsDefinition) {
  const SurfaceCurve curve = sphere_curve();
  for (const Vec3d& eye : {Vec3d(0, 0, 3), Vec3d(-2, 5, 1), Vec3d(0.9, 0.9, 0.9), Vec3d(0, -1.01, 0), Vec3d(1e3, 0, -1e3)}) {
    for (const double s0 : {1e-3, 0.1, 2.0}) expect_view(curve, eye, s0);
  }
}

TEST(Density, OfAViewIsRightForEyesAsFarAsDoublesGo) {
  const SurfaceCurve curve = sphere_curve();
  for (const double distance : {1e5, 1e7, 1e30, 1e100, 1.5e308}) {
    expect_view(curve, {0, 0, distance}, 0.1);
    expect_view(curve, {-distance, distance, distance}, 0.1);
  }
}

TEST(Density, OfAViewIsRightAtEverySizeThatRepairLetsThrough) {
  for (const double radius : {1e-12, 1e-5, 1e5, 1e10, 2e14}) {
    const SurfaceCurve curve = sphere_curve(2000, radius);
    for (const double distance : {1.5, 30.0, 1e8}) expect_view(curve, radius * distance * Vec3d(0.6, 0, -0.8), 0.1);
  }
}

TEST(Density, OfAViewTakesTheEyeInAbsoluteCoordinates) {
  const Vec3d origin(1e7, -3e7, 2e7);
  const SurfaceCurve curve = sphere_curve(5000, 1, origin);
  expect_view(curve, origin + Vec3d(2, 1, 0), 0.1);
  const std::vector<float> there = density_of(curve, {ViewTerm{.eye = origin + Vec3d(2, 1, 0)}});
  EXPECT_EQ(there, density_of(sphere_curve(), {ViewTerm{.eye = Vec3d(2, 1, 0)}}));
}

TEST(Density, OfAViewRisesTowardsTheSilhouette) {
  for (const double s0 : {0.05, 0.1, 0.5}) {
    const std::vector<float> density = density_of(sphere_curve(200'000), {ViewTerm{.eye = Vec3d(0, 0, 1000), .s0 = s0}});
    float smallest = 1e30f, largest = 0;
    for (const float d : density) {
      if (d > 0) smallest = std::min(smallest, d);
      largest = std::max(largest, d);
    }
    EXPECT_NEAR(largest / smallest, (1 + s0) / s0, 0.05 * (1 + s0) / s0) << s0;
  }
}

TEST(Density, OfAViewFromInsideIsZero) {
  EXPECT_THAT(density_of(sphere_curve(), {ViewTerm{.eye = Vec3d(0.2, -0.1, 0.3)}}), Each(0.0f));
}

TEST(Density, OfAViewIsPositiveOnAllThatFacesTheEye) {
  // A plane seen squarely from afar: 1 - c vanishes, s0 alone is left.
  SurfaceCurve curve = sphere_curve(100);
  for (std::size_t l = 0; l < curve.size(); ++l) {
    curve.z[l] = 0;
    curve.nx[l] = curve.ny[l] = 0;
    curve.nz[l] = 1;
  }
  for (const double s0 : {1e-3, 1e-6, 1e-9}) {
    const std::vector<float> density = density_of(curve, {ViewTerm{.eye = Vec3d(0, 0, 1e30), .s0 = s0}});
    for (const float d : density) ASSERT_NEAR(d / s0, 1, 0.01) << s0;
  }
}

TEST(Density, OfAViewAtAPointOfTheSurfaceIsFinite) {
  const SurfaceCurve curve = sphere_curve(100);
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const std::vector<float> density = density_of(curve, {ViewTerm{.eye = Vec3d(curve.x[l], curve.y[l], curve.z[l])}});
    for (const float d : density) ASSERT_TRUE(std::isfinite(d) && d >= 0);
  }
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
  const std::vector<DensityTerm> terms = {CurvatureTerm{.kind = CurvatureKind::kMax, .exponent = 0.7},
                                          ViewTerm{.eye = Vec3d(1, 2, 3)}, UniformTerm{}, CurvatureTerm{.floor = 0.2}};
  std::vector<double> product(curve.size(), 1.0);
  for (const DensityTerm& term : terms) {
    const std::vector<float> one = density_of(curve, {term});
    for (std::size_t l = 0; l < curve.size(); ++l) product[l] *= one[l];
  }
  std::vector<DensityTerm> reversed(terms.rbegin(), terms.rend());
  for (const auto& order : {terms, reversed}) {
    const std::vector<float> density = density_of(curve, order);
    for (std::size_t l = 0; l < curve.size(); ++l) ASSERT_NEAR(density[l], product[l], 1e-6 * product[l]) << "vertex " << l;
  }
}

TEST(Density, RefusesBadValuesByName) {
  for (const double bad : {-1.0, kNaN, kInfinity}) expect_refused(CurvatureTerm{.exponent = bad}, "curvature", "exponent");
  for (const double bad : {-0.01, 1.01, kNaN, kInfinity}) expect_refused(CurvatureTerm{.floor = bad}, "curvature", "floor");
  for (const double bad : {0.0, -0.1, kNaN, kInfinity}) expect_refused(ViewTerm{.s0 = bad}, "view", "s0");
  for (const double bad : {kNaN, kInfinity, -kInfinity}) expect_refused(ViewTerm{.eye = Vec3d(0, bad, 0)}, "view", "eye");
}

TEST(Density, IsFiniteForHugeValuesOrRefusesThem) {
  const SurfaceCurve curve = sphere_curve(500);
  std::vector<float> density(curve.size());
  for (const double huge : {1e30, 1e39, 1e300}) {
    const std::vector<DensityTerm> view = {ViewTerm{.eye = Vec3d(0, 0, 3), .s0 = huge}};
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
