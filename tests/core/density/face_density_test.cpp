#include "core/density/face_density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

TEST(FaceDensity, TakesAttributesFromTheCorners) {
  const TriangleMesh mesh = testing::make_mesh(testing::square(4));
  const std::vector<VertexGeometry> geometry = differential_geometry(mesh);
  ScalarAttribute height{"height", {}};
  for (const Vec3d& p : mesh.positions) height.values.push_back(static_cast<float>(p.x()));
  const std::vector<ScalarAttribute> scalars = {height};
  for (const DensityTerm& term :
       std::vector<DensityTerm>{AttributeTerm{"height"}, ExpressionTerm{"height"}, ExpressionTerm{"x"}}) {
    const auto values = density_on_faces(mesh, geometry, scalars, {term});
    ASSERT_TRUE(values.ok()) << values.status();
    double scale = 0;
    for (std::size_t f = 0; f < values->size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      const double x = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]).x() / 3;
      if (f == 0) scale = x / static_cast<double>((*values)[0]);
      EXPECT_NEAR((*values)[f] * scale, x, 1e-5) << f;
    }
  }
  const auto unknown = density_on_faces(mesh, geometry, scalars, {AttributeTerm{"depth"}});
  EXPECT_EQ(unknown.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(std::string(unknown.status().message()).find("there are: height"), std::string::npos);
}

TEST(FaceDensity, IsTheMeanOnTheFace) {
  // Two triangles: the mean of x y on the lower one, with corners (0, 0), (1, 0), (1, 1), is 1/4, and so on the upper one.
  const TriangleMesh mesh = testing::make_mesh(testing::square(1));
  ASSERT_EQ(mesh.face_count(), 2u);
  for (const std::size_t k : {1u, 2u, 3u, 16u}) {
    const auto values = density_on_faces(mesh, differential_geometry(mesh), {}, {ExpressionTerm{"x * y"}}, 2 * 3 * k * k);
    ASSERT_TRUE(values.ok()) << values.status();
    // Relative to the largest value that was looked at, next to the corner (1, 1) of one of k^2 triangles.
    const double n = static_cast<double>(k), largest = (1 - 1 / (6 * n)) * (1 - 2 / (6 * n));
    EXPECT_NEAR((*values)[0] * largest, 0.25, 1e-5) << k;
    EXPECT_NEAR((*values)[1] * largest, 0.25, 1e-5) << k;
  }
  // The centroid alone.
  const auto coarse = density_on_faces(mesh, differential_geometry(mesh), {}, {ExpressionTerm{"x"}}, 2);
  ASSERT_TRUE(coarse.ok());
  EXPECT_NEAR(std::min((*coarse)[0], (*coarse)[1]) / std::max((*coarse)[0], (*coarse)[1]), 0.5, 1e-5);
}

}  // namespace
}  // namespace curvecast
