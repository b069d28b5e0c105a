#include "core/density/face_density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

TEST(FaceDensity, TakesAttributesFromTheCorners) {
  const TriangleMesh mesh = testing::make_mesh(testing::square(4));
  const DifferentialGeometry geometry = differential_geometry(mesh);
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
  const auto values = density_on_faces(mesh, differential_geometry(mesh), {}, {ExpressionTerm{"x * y"}});
  ASSERT_TRUE(values.ok()) << values.status();
  EXPECT_NEAR((*values)[0], (*values)[1], 1e-6);
  double exact = 0;
  for (const Vec3d& p : mesh.positions) exact = std::max(exact, p.x() * p.y());
  ASSERT_EQ(exact, 1) << "the unit square";
  // Relative to the largest value that was looked at, next to the corner (1, 1).
  EXPECT_NEAR((*values)[0] * (11.0 / 12) * (10.0 / 12), 0.25, 1e-5);
}

}  // namespace
}  // namespace curvecast
