#include "core/sample/view_mass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/pipeline/pipeline.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::shared_ptr<const SurfaceCurve> curve_of(const PolygonSoup& soup, std::uint64_t points) {
  const std::string off = to_off(soup);
  absl::StatusOr<Preprocessed> made = preprocess({"shape.off", off}, {.points = points});
  EXPECT_TRUE(made.ok()) << made.status();
  return made->curve;
}

/// Mass of every vertex, one by one.
std::vector<float> masses(const SurfaceCurve& curve, const Density& terms) {
  std::vector<float> mass(curve.size());
  EXPECT_TRUE(evaluate_density(curve, terms, mass).ok());
  for (std::size_t l = 0; l < mass.size(); ++l) mass[l] *= curve.area[l];
  return mass;
}

const std::vector<Vec3d> kEyes = {{0, 0, 5}, {1.5, 0.3, 0.2}, {100, -300, 50}, {0.9, 0.9, 0.9}, {0, 0, 1e9}};

TEST(ViewMass, IsThatOfTheVertices) {
  for (const PolygonSoup& soup : {icosphere(5), torus(60, 30), perforated_slab(5, 3)}) {
    const auto curve = curve_of(soup, 20'000);
    for (const Vec3d& eye : kEyes) {
      const Density terms = seen_from(eye);
      const std::vector<float> exact = masses(*curve, terms);
      double total = 0;
      for (const float m : exact) total += static_cast<double>(m);
      for (const std::uint64_t points : {10u, 1000u, 20'000u, 1'000'000u}) {
        ViewMass mass;
        view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, terms), points, mass);
        const double point = total / static_cast<double>(points);
        EXPECT_NEAR(mass.total / total, 1, 1e-2) << eye.transpose() << ", " << points << " points";
        double sum = 0;
        float largest = 0;
        for (std::size_t b = 0; b < mass.sum.size(); ++b) {
          double of_block = 0;
          for (std::size_t l = b * kBlockSize; l < std::min((b + 1) * kBlockSize, exact.size()); ++l) {
            of_block += static_cast<double>(exact[l]);
            largest = std::max(largest, exact[l]);
          }
          ASSERT_NEAR(mass.sum[b], of_block, 0.5 * point + 1e-5 * of_block) << "block " << b;
          sum += static_cast<double>(mass.sum[b]);
        }
        EXPECT_NEAR(sum / mass.total, 1, 1e-9);
        // Never too much, also in relation to the whole.
        EXPECT_LE(mass.largest / mass.total, largest / total);
      }
    }
  }
}

TEST(ViewMass, OfManyPointsIsExact) {
  const auto curve = curve_of(icosphere(4), 2000);
  const Density terms = seen_from(Vec3d(0.3, 2, 2), {ViewTerm{}, CurvatureTerm{}});
  std::vector<float> fixed(curve->size());
  ASSERT_TRUE(evaluate_fixed_terms(*curve, terms.terms, fixed).ok());
  const BlockMass fixed_mass = block_mass(fixed, curve->area);
  ViewMass mass;
  view_mass(*curve, fixed, fixed_mass, ViewFactor(*curve, terms), 1'000'000'000, mass);
  const std::vector<float> exact = masses(*curve, terms);
  float largest = 0;
  for (std::size_t b = 0; b < mass.sum.size(); ++b) {
    double of_block = 0;
    for (std::size_t l = b * kBlockSize; l < std::min((b + 1) * kBlockSize, exact.size()); ++l) {
      of_block += static_cast<double>(exact[l]);
      largest = std::max(largest, exact[l]);
    }
    ASSERT_NEAR(mass.sum[b], of_block, 1e-5 * of_block);
  }
  EXPECT_NEAR(mass.largest, largest, 0.1 * largest);
}

TEST(ViewMass, IsZeroOnWhatFacesAway) {
  const auto curve = curve_of(icosphere(5), 20'000);
  const Density terms = seen_from(Vec3d(0, 0, 4));
  ViewMass mass;
  view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, terms), 100, mass);
  for (std::size_t b = 0; b < mass.sum.size(); ++b) {
    bool any = false;
    for (std::size_t l = b * kBlockSize; l < std::min((b + 1) * kBlockSize, curve->size()); ++l) {
      any = any || (Vec3f(0, 0, 4) - curve->position(l)).dot(curve->normal(l)) > 0;
    }
    EXPECT_EQ(mass.sum[b] > 0, any) << "block " << b;
  }
  // From within nothing faces the eye.
  view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, seen_from(Vec3d::Zero())), 100, mass);
  EXPECT_EQ(mass.total, 0);
}

TEST(ViewMass, TakesFewVerticesForAFewPoints) {
  const auto curve = curve_of(icosphere(6), 100'000);
  const Density terms = seen_from(Vec3d(0, 0, 4));
  ViewMass mass;
  view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, terms), 5000, mass);
  // Only those about the outline, and where the view changes fast beside it.
  EXPECT_LT(mass.own_codes.size(), mass.sum.size() / 8);
  EXPECT_GT(mass.own_codes.size(), 0u);
}

TEST(ViewMass, WithoutAViewIsTheFixedMass) {
  const auto curve = curve_of(torus(20, 10), 500);
  ViewMass mass, again;
  view_mass(*curve, {}, curve->blocks.area, ViewFactor(*curve, {}), 100, mass);
  fixed_mass(curve->blocks.area, again);
  EXPECT_EQ(mass.sum, again.sum);
  EXPECT_EQ(mass.total, again.total);
  EXPECT_NEAR(mass.total / curve->total_area, 1, 1e-5);
  float largest = 0;
  for (const float area : curve->area) largest = std::max(largest, area);
  EXPECT_EQ(mass.largest, largest);
}

}  // namespace
}  // namespace curvecast
