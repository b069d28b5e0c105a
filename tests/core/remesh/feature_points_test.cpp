#include "core/remesh/feature_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

Vec3d place_of(const TriangleMesh& mesh, const FacePlace& place) {
  const Triangle& t = mesh.triangles[place.face];
  const double first = 1.0 - place.weight_1 - place.weight_2;
  return first * mesh.positions[t[0]] + place.weight_1 * mesh.positions[t[1]] + place.weight_2 * mesh.positions[t[2]];
}

TEST(FeaturePoints, LieEvenlyOnTheTwelveEdgesOfACube) {
  const TriangleMesh mesh = make_mesh(cube());
  const FeaturePoints found = sample_features(mesh, 30, 12'000, 1);
  EXPECT_NEAR(found.length, 12, 1e-12);
  ASSERT_EQ(found.positions.size(), 12'000u);
  std::map<std::array<int, 3>, int> of_edge;  // by the coordinates that are 0 or 1; 2: the one along the edge
  for (std::size_t i = 0; i < found.positions.size(); ++i) {
    const Vec3d& p = found.positions[i];
    EXPECT_LT((place_of(mesh, found.places[i]) - p).norm(), 1e-6);
    std::array<int, 3> edge{};
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_end = std::min(std::abs(p[axis]), std::abs(1 - p[axis])) < 1e-12;
      edge[static_cast<std::size_t>(axis)] = is_end ? static_cast<int>(std::round(p[axis])) : 2;
    }
    EXPECT_EQ(std::count(edge.begin(), edge.end(), 2), 1) << p.transpose();
    ++of_edge[edge];
    const auto& [a, b] = found.normals[i];
    EXPECT_NEAR(a.norm(), 1, 1e-6);
    EXPECT_NEAR(a.dot(b), 0, 1e-6);
  }
  ASSERT_EQ(of_edge.size(), 12u);
  for (const auto& [edge, count] : of_edge) EXPECT_NEAR(count, 1000, 1.5);
}

TEST(FeaturePoints, AreTheSameForTheSameSeedAndOthersForAnother) {
  const TriangleMesh mesh = make_mesh(cube());
  const FeaturePoints one = sample_features(mesh, 30, 100, 7), again = sample_features(mesh, 30, 100, 7),
                      other = sample_features(mesh, 30, 100, 8);
  EXPECT_EQ(one.positions, again.positions);
  EXPECT_NE(one.positions, other.positions);
}

TEST(FeaturePoints, AreNoneOnSmoothSurfacesAndOnBorders) {
  for (const PolygonSoup& soup : {icosphere(3), square(4), open_cylinder(4, 40)}) {
    const FeaturePoints found = sample_features(make_mesh(soup), 30, 100, 1);
    EXPECT_EQ(found.length, 0);
    EXPECT_TRUE(found.positions.empty());
  }
}

}  // namespace
}  // namespace curvecast
