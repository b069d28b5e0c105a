#include "core/mesh/face_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/mesh/centroid.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

void expect_all_once(std::vector<std::uint32_t> order, std::size_t faces) {
  ASSERT_EQ(order.size(), faces);
  std::sort(order.begin(), order.end());
  for (std::uint32_t f = 0; f < faces; ++f) ASSERT_EQ(order[f], f);
}

/// A mesh of one small face in the middle of each cell of a cube of 2^level a side.
TriangleMesh faces_in_cells(int level) {
  TriangleMesh mesh;
  const int side = 1 << level;
  const double size = 0.1 / side;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int z = 0; z < side; ++z) {
        const auto v = static_cast<std::uint32_t>(mesh.positions.size());
        const Vec3d at = Vec3d(x + 0.5, y + 0.5, z + 0.5) / side;
        mesh.positions.insert(mesh.positions.end(), {at - Vec3d(size, 0, 0), at + Vec3d(size, -size, 0), at + Vec3d(0, size, 0)});
        mesh.triangles.push_back({v, v + 1, v + 2});
      }
    }
  }
  mesh.twins.assign(3 * mesh.face_count(), kNone);
  mesh.positions.insert(mesh.positions.end(), {{0, 0, 0}, {1, 1, 1}});  // the box is that of the cells
  return mesh;
}

TEST(FaceOrder, IsAHilbertCurve) {
  // From cell to cell the curve goes through a side, never over an edge or farther: so it does at every level.
  for (const int level : {1, 2, 3, 4}) {
    const TriangleMesh mesh = faces_in_cells(level);
    const std::vector<std::uint32_t> order = face_order(mesh);
    expect_all_once(order, mesh.face_count());
    const double step = 1.0 / (1 << level);
    for (std::size_t i = 1; i < order.size(); ++i) {
      const Vec3d way = centroid(mesh, order[i]) - centroid(mesh, order[i - 1]);
      ASSERT_NEAR(way.norm(), step, 1e-9) << level << " " << i;
      ASSERT_NEAR(way.cwiseAbs().maxCoeff(), step, 1e-9);
    }
  }
}

TEST(FaceOrder, NeighboursInItAreNearEachOther) {
  const TriangleMesh ball = testing::make_mesh(testing::jittered(testing::icosphere(5), 0.003));
  const std::vector<std::uint32_t> order = face_order(ball);
  expect_all_once(order, ball.face_count());
  const double size = std::sqrt(surface_area(ball) / static_cast<double>(ball.face_count()));
  double sum = 0;
  std::size_t far = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const double way = (centroid(ball, order[i]) - centroid(ball, order[i - 1])).norm();
    sum += way;
    far += way > 4 * size;
  }
  EXPECT_LT(sum / static_cast<double>(order.size()), 2 * size);
  EXPECT_LT(far, order.size() / 20) << "where the curve leaves one part of the surface for the next";
}

TEST(FaceOrder, TakesMeshesOfOneFaceAndOfNoWidth) {
  TriangleMesh mesh;
  mesh.positions = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  EXPECT_TRUE(face_order(mesh).empty());
  mesh.triangles = {{0, 1, 2}, {0, 1, 2}};
  mesh.twins.assign(6, kNone);
  EXPECT_EQ(face_order(mesh), (std::vector<std::uint32_t>{0, 1}));
}

}  // namespace
}  // namespace curvecast
