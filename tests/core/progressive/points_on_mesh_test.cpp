// Points of both samplers lie on the mesh, at any depth. The distance is measured by a tree of triangles, not by what placed
// them.
#include <gtest/gtest.h>

#include <string>

#include "core/measure/triangle_tree.h"
#include "core/pipeline/curve_surface.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/sample_ranked.h"
#include "core/sample/resample.h"
#include "core/sample/spread_in_leaves.h"
#include "tests/support/real_mesh.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// Floats of positions relative to the curve's origin are rounded by this at most.
double tolerance(const SurfaceCurve& curve) { return 1e-6 * curve.box.diagonal(); }

double farthest_from(const TriangleTree& tree, const PointSet& points) {
  double farthest = 0;
  for (const Vec3f& p : points.positions) {
    farthest = std::max(farthest, tree.nearest(points.origin + p.cast<double>()).distance);
  }
  return farthest;
}

/// Looks at a place of the surface from nearer and nearer.
void expect_on_mesh(const Preprocessed& done) {
  const SurfaceCurve& curve = *done.curve;
  const TriangleTree tree(done.flattened->loaded.mesh);
  const auto surface = leaf_surface(done);
  const double size = curve.box.diagonal();
  const std::size_t l = curve.size() / 3;
  const Vec3d at = curve.origin + curve.position(l).cast<double>(), normal = curve.normal(l).cast<double>();
  auto grower = RankGrower::make(surface, {.level = 6});
  ASSERT_TRUE(grower.ok()) << grower.status();
  for (const double distance : {1.0, 0.05, 0.002}) {
    Camera camera = camera_at(at + distance * size * normal, at);
    camera.fov = 0.7;
    const Density density{{ScreenTerm{}, FrustumTerm{}}, {camera}};
    RankedWorkspace workspace;
    for (;;) {
      const absl::Status status = sample_ranked(curve, (*grower)->tree(), nullptr, density, 3000, workspace);
      ASSERT_TRUE(status.ok()) << status;
      if (workspace.selection.lacking.empty()) break;
      ASSERT_TRUE((*grower)->grow(workspace.selection.most_lacking(), 4'000'000).ok());
    }
    EXPECT_EQ(workspace.points.size(), 3000u) << distance;
    EXPECT_LE(farthest_from(tree, workspace.points), tolerance(curve)) << distance;
    absl::StatusOr<PointSet> equalised = resample(curve, {.points = 3000, .density = density});
    ASSERT_TRUE(equalised.ok()) << equalised.status();
    spread_in_leaves(*surface, *equalised);
    EXPECT_LE(farthest_from(tree, *equalised), tolerance(curve)) << distance;
  }
}

TEST(PointsOnMesh, OfShapes) {
  // Smooth and creased, stretched, with a border, of several pieces.
  const PolygonSoup blade = soup_of({{0, 0, 0}, {1, 0, 0}, {1, 8, 0}, {0, 8, 0}, {0, 0, 30}, {1, 0, 30}, {1, 8, 30}, {0, 8, 30}},
                                    {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
  for (const PolygonSoup& soup : {icosphere(3), blade, torus(24, 48), open_cylinder(8, 24), perforated_slab(3, 3),
                                  merged(icosphere(2), translated(torus(12, 9), {4, 0, 0}))}) {
    const std::string off = to_off(soup);
    const absl::StatusOr<Preprocessed> done = preprocess({"shape.off", off}, {.points = 4000});
    ASSERT_TRUE(done.ok()) << done.status();
    expect_on_mesh(*done);
  }
}

class RealMeshPoints : public ::testing::TestWithParam<const char*> {};

TEST_P(RealMeshPoints, LieOnTheMesh) {
  const RealMesh file = real_mesh(GetParam());
  const absl::StatusOr<Preprocessed> done = preprocess({file.name, file.bytes}, {.points = 16'384});
  ASSERT_TRUE(done.ok()) << done.status();
  expect_on_mesh(*done);
}

INSTANTIATE_TEST_SUITE_P(Shared, RealMeshPoints, ::testing::ValuesIn(real_mesh_names()));

}  // namespace
}  // namespace curvecast
