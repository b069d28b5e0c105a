// Both mappers and both area elements, on real meshes.
#include <gtest/gtest.h>

#include <string>

#include "core/pipeline/pipeline.h"
#include "tests/support/real_mesh.h"

namespace curvecast {
namespace {

class RealMeshCurve : public ::testing::TestWithParam<const char*> {};

TEST_P(RealMeshCurve, IsTheSameByBothMappersAndHasTheSurfacesAreaByBothElements) {
  const testing::RealMesh file = testing::real_mesh(GetParam());
  PreprocessOptions options{.points = 65'536};
  absl::StatusOr<FlattenedMesh> flattened = flatten_mesh({file.name, file.bytes}, options);
  ASSERT_TRUE(flattened.ok()) << flattened.status();
  const auto shared = std::make_shared<const FlattenedMesh>(*std::move(flattened));
  const absl::StatusOr<Preprocessed> exact = lay_curve(shared, options);
  options.mapper = Mapper::kIdBuffer;
  options.area_element = AreaElement::kVoronoi;
  const absl::StatusOr<Preprocessed> other = lay_curve(shared, options);
  ASSERT_TRUE(exact.ok() && other.ok()) << exact.status() << other.status();
  EXPECT_LT(exact->report.area_error, 1e-6);
  EXPECT_LT(other->report.area_error, 0.005);

  const SurfaceCurve &a = *exact->curve, &b = *other->curve;
  ASSERT_EQ(a.size(), b.size());
  // Where a centre lies on a common edge the triangles may differ, but not the place.
  const double tolerance = 1e-6 * a.box.diagonal();
  std::size_t different = 0;
  for (std::size_t l = 0; l < a.size(); ++l) {
    different += a.triangle[l] != b.triangle[l];
    ASSERT_LT((a.position(l) - b.position(l)).cast<double>().norm(), tolerance) << "vertex " << l;
  }
  EXPECT_LT(different, a.size() / 10'000);
  double sum = 0;
  for (const float area : b.area) {
    ASSERT_GT(area, 0);
    sum += static_cast<double>(area);
  }
  EXPECT_NEAR(sum, b.total_area, 1e-6 * sum);
}

INSTANTIATE_TEST_SUITE_P(Shared, RealMeshCurve, ::testing::ValuesIn(testing::real_mesh_names()));

}  // namespace
}  // namespace curvecast
