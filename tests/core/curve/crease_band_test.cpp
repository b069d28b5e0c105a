#include "core/curve/crease_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/density/density.h"
#include "core/refine/refine.h"
#include "tests/core/refine/refined.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// The distance to the nearest edge of the cube, for a place on one of its faces, and the outward axis of the face beyond.
struct NearEdge {
  double distance;
  Vec3f beyond;
};

NearEdge near_edge(const SurfaceCurve& curve, std::size_t l) {
  const Vec3d middle = curve.box.center(), half = 0.5 * (curve.box.max - curve.box.min);
  const Vec3d at = curve.origin + curve.position(l).cast<double>() - middle;
  NearEdge out{1e30, Vec3f::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(curve.normal(l)[axis]) > 0.5F) continue;
    const double distance = half[axis] - std::abs(at[axis]);
    if (distance >= out.distance) continue;
    out.distance = distance;
    out.beyond = Vec3f::Zero();
    out.beyond[axis] = at[axis] > 0 ? 1 : -1;
  }
  return out;
}

void expect_band_of_cube(const SurfaceCurve& curve, double slack) {
  const double reach = kCreaseBand * curve.box.diagonal();
  ASSERT_EQ(curve.beside.size(), curve.size());
  std::size_t inside = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const NearEdge edge = near_edge(curve, l);
    if (edge.distance > reach + slack) {
      EXPECT_TRUE(curve.beside[l].is_none()) << "vertex " << l << ", " << edge.distance / reach << " of the band";
    } else if (edge.distance < 0.9 * reach - slack) {
      ++inside;
      const Vec3f beside = curve.beside[l].unpacked<Vec3f>();
      EXPECT_LT(std::abs(beside.dot(curve.normal(l))), 0.01F) << "vertex " << l;
      EXPECT_NEAR(beside.norm(), 1, 0.01) << "vertex " << l;
    }
  }
  EXPECT_GT(inside, curve.size() / 100);
}

TEST(CreaseBand, TellsOfTheFaceBeyondEachEdgeOfACube) {
  const auto shape = refinable(cube(), 20'000);
  const SurfaceCurve& curve = shape->curve();
  expect_band_of_cube(curve, 0);
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const NearEdge edge = near_edge(curve, l);
    if (curve.beside[l].is_none() || edge.distance > 0.5 * kCreaseBand * curve.box.diagonal()) continue;
    // At a corner two faces are as near.
    const bool is_corner = (curve.origin + curve.position(l).cast<double>() - curve.box.center()).cwiseAbs().minCoeff() >
                           0.5 * (curve.box.max - curve.box.min)[0] - 2 * kCreaseBand * curve.box.diagonal();
    if (is_corner) continue;
    EXPECT_GT(curve.beside[l].unpacked<Vec3f>().dot(edge.beyond), 0.99F) << "vertex " << l;
  }
}

TEST(CreaseBand, IsThereOnlyWhereCreasesAre) {
  EXPECT_TRUE(refinable(icosphere(4), 5000)->curve().beside.empty());
  EXPECT_TRUE(refinable(square(4), 5000)->curve().beside.empty()) << "a border is no crease";
  const auto pair = refinable(merged(icosphere(4), translated(cube(), {4, 0, 0})), 20'000);
  const SurfaceCurve& curve = pair->curve();
  ASSERT_EQ(curve.beside.size(), curve.size());
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const bool is_on_sphere = curve.origin.x() + static_cast<double>(curve.x[l]) < 2;
    EXPECT_FALSE(is_on_sphere && !curve.beside[l].is_none()) << "vertex " << l;
  }
}

TEST(CreaseBand, AFinerCurveHasItFromTheCoarser) {
  const auto shape = refinable(cube(), 20'000);
  const double leaf = 0.006 * shape->curve().box.diagonal();
  for (const CurveDemand& demand :
       {CurveDemand{.points = 300'000}, CurveDemand{.points = 100'000, .density = seen_from({0.3, 2, 5})}}) {
    const absl::StatusOr<RefinedCurve> finer = refine(*shape->base, shape->curve(), {&demand, 1}, {});
    ASSERT_TRUE(finer.ok()) << finer.status();
    ASSERT_NE(finer->curve, nullptr);
    expect_band_of_cube(*finer->curve, leaf);
  }
}

TEST(CreaseBand, APictureHasPointsThereWhereTheOtherSideIsSeen) {
  const auto shape = refinable(cube(), 20'000);
  const SurfaceCurve& curve = shape->curve();
  const Vec3d centre = curve.box.center(), eye = centre + Vec3d(4, 3, 2) * curve.box.diagonal();
  Density terms = seen_from(eye, {PictureTerm{}});
  terms.cameras[0].target = centre;
  std::vector<float> density(curve.size());
  ASSERT_TRUE(evaluate_density(curve, terms, density).ok());
  std::size_t hidden = 0, beside = 0;
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const auto faces = [&](const Vec3f& normal) { return normal.sum() > 0.5F; };
    if (faces(curve.normal(l))) {
      EXPECT_GT(density[l], 0) << "vertex " << l;
      continue;
    }
    const bool is_beside = faces(curve.beside[l].unpacked<Vec3f>());
    EXPECT_EQ(density[l] > 0, is_beside) << "vertex " << l;
    beside += is_beside ? 1 : 0;
    ++hidden;
  }
  EXPECT_GT(beside, hidden / 50);
  EXPECT_LT(beside, hidden / 10);
  // What faces away has none in a view term, as ever.
  ASSERT_TRUE(evaluate_density(curve, seen_from(eye, {ViewTerm{}}), density).ok());
  for (std::size_t l = 0; l < curve.size(); ++l) EXPECT_EQ(density[l] > 0, curve.normal(l).sum() > 0.5F) << "vertex " << l;
}

}  // namespace
}  // namespace curvecast
