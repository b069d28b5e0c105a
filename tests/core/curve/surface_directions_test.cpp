#include <gtest/gtest.h>

#include "core/curve/tangent_frame.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/analytic_directions.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::shared_ptr<const SurfaceCurve> curve_on(const PolygonSoup& soup) {
  const absl::StatusOr<Preprocessed> result = preprocess({"shape.off", to_off(soup)}, {.points = 500});
  EXPECT_TRUE(result.ok()) << result.status();
  return result->curve;
}

void expect_directions(const PolygonSoup& soup, const AnalyticDirection& truth, double tolerance) {
  const std::shared_ptr<const SurfaceCurve> curve = curve_on(soup);
  std::size_t checked = 0;
  for (std::size_t l = 0; l < curve->size(); ++l) {
    const Vec3f direction = unpack_direction(curve->direction[l], curve->normal(l));
    EXPECT_NEAR(direction.norm(), 1, 1e-5);
    EXPECT_NEAR(direction.dot(curve->normal(l)), 0, 1e-4);
    const std::optional<Vec3d> wanted = truth(curve->position(l).cast<double>());
    if (!wanted) continue;
    ++checked;
    EXPECT_LT(axis_angle(direction.cast<double>(), *wanted), tolerance) << "curve vertex " << l;
  }
  EXPECT_GT(checked, curve->size() / 4);
}

// The curve lies on flat faces, whose points are not quite where the surface has its directions: a little more leeway.
TEST(SurfaceDirections, DirectionsFollowKnownSurfaces) {
  for (const auto& [soup, direction, tolerance] : known_surfaces()) expect_directions(soup, direction, tolerance);
}

TEST(SurfaceDirections, CurvaturesAreThoseOfASphere) {
  const std::shared_ptr<const SurfaceCurve> curve = curve_on(icosphere(4, 2));
  for (std::size_t l = 0; l < curve->size(); ++l) {
    EXPECT_NEAR(curve->curvature_min[l] * curve->curvature_max[l], 0.25, 0.02);
    EXPECT_NEAR(0.5f * (curve->curvature_min[l] + curve->curvature_max[l]), 0.5, 0.02);
  }
}

}  // namespace
}  // namespace curvecast
