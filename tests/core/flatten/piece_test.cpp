#include "core/flatten/piece.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/mesh/topology.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

TEST(Piece, KeepsFacesInTheirOrder) {
  const TriangleMesh mesh = testing::make_mesh(testing::sphere(16, 24));
  std::vector<std::uint32_t> half(mesh.face_count() / 2);
  std::iota(half.begin(), half.end(), 10u);
  const TriangleMesh piece = extract_piece(mesh, half);
  ASSERT_EQ(piece.face_count(), half.size());
  for (std::size_t f = 0; f < half.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(piece.positions[piece.triangles[f][i]], mesh.positions[mesh.triangles[half[f]][i]]);
    }
  }
  EXPECT_EQ(analyse_topology(piece).boundary_loops, 1u);
}

TEST(Piece, FacesThatMeetInAPointComeApart) {
  // Two opposite faces of an octahedron's four around one tip.
  const TriangleMesh mesh = testing::make_mesh(testing::icosphere(1));
  std::vector<std::uint32_t> around;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    for (const std::uint32_t v : mesh.triangles[f]) {
      if (v == 0) around.push_back(f);
    }
  }
  ASSERT_GE(around.size(), 4u);
  std::uint32_t other = 1;
  while (other < around.size() &&
         (mesh.twins[3 * around[0]] / 3 == around[other] || mesh.twins[3 * around[0] + 1] / 3 == around[other] ||
          mesh.twins[3 * around[0] + 2] / 3 == around[other])) {
    ++other;
  }
  ASSERT_LT(other, around.size());
  const TriangleMesh piece = extract_piece(mesh, std::vector<std::uint32_t>{around[0], around[other]});
  EXPECT_EQ(piece.vertex_count(), 6u);
}

}  // namespace
}  // namespace curvecast
