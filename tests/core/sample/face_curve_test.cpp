#include "core/sample/face_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/shapes.h"

namespace curvecast {
namespace {

constexpr double kWhole = std::numeric_limits<double>::infinity();

Vec3d place(const TriangleMesh& mesh, std::uint32_t face, const std::array<float, 2>& weights) {
  const Triangle& t = mesh.triangles[face];
  const auto [second, third] = weights;
  return (1 - second - third) * mesh.positions[t[0]] + second * mesh.positions[t[1]] + third * mesh.positions[t[2]];
}

TEST(FaceCurve, PassesAllFacesOnce) {
  const TriangleMesh ball = testing::make_mesh(testing::jittered(testing::icosphere(3), 0.02));
  const FaceCurve curve(ball, kWhole);
  ASSERT_EQ(curve.size(), ball.face_count());
  std::vector<int> passed(ball.face_count());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    ++passed[curve.face(i)];
    ASSERT_EQ(curve.area(i), triangle_area(ball, curve.face(i)));
  }
  EXPECT_EQ(passed, std::vector<int>(ball.face_count(), 1));
}

TEST(FaceCurve, DividesLargeFacesOnly) {
  // Faces of a box of which some are ten times as large as others.
  TriangleMesh mesh = testing::make_mesh(testing::cube());
  for (Vec3d& p : mesh.positions) p.z() *= 10;
  double smallest = kWhole;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) smallest = std::min(smallest, triangle_area(mesh, f));
  const FaceCurve curve(mesh, smallest);
  double sum = 0;
  std::vector<int> pieces(mesh.face_count());
  for (std::size_t i = 0; i < curve.size(); ++i) {
    ASSERT_LE(curve.area(i), smallest * (1 + 1e-12));
    sum += curve.area(i);
    ++pieces[curve.face(i)];
  }
  EXPECT_NEAR(sum, surface_area(mesh), 1e-9 * sum);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) ASSERT_EQ(pieces[f], triangle_area(mesh, f) > 5 * smallest ? 16 : 1);
}

TEST(FaceCurve, GoesThroughPiecesAsThroughTheirFaces) {
  const TriangleMesh square = testing::make_mesh(testing::square(1));
  constexpr std::size_t kPieces = 64;
  const FaceCurve whole(square, kWhole), pieces(square, 0.5 / kPieces);
  ASSERT_EQ(pieces.size(), 2 * kPieces);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    ASSERT_EQ(pieces.face(i), whole.face(i / kPieces));
    for (const double part : {0.0, 0.3, 0.9}) {
      const auto of_piece = pieces.way(i).at(part, 20);
      const auto of_face = whole.way(i / kPieces).at((static_cast<double>(i % kPieces) + part) / kPieces, 26);
      ASSERT_LT((place(square, pieces.face(i), of_piece) - place(square, pieces.face(i), of_face)).norm(), 1e-6);
    }
  }
}

TEST(FaceCurve, HasNoJumpWithinAFace) {
  const TriangleMesh square = testing::make_mesh(testing::square(1));
  const FaceCurve curve(square, kWhole);
  constexpr std::size_t kSteps = 4096;
  Vec3d sum = Vec3d::Zero();
  for (std::size_t piece = 0; piece < curve.size(); ++piece) {
    const FaceCurve::Way way = curve.way(piece);
    Vec3d before = place(square, curve.face(piece), way.at(0, 20));
    for (std::size_t i = 0; i < kSteps; ++i) {
      const auto weights = way.at((static_cast<double>(i) + 0.5) / kSteps, 20);
      ASSERT_GE(std::min({weights[0], weights[1], 1 - weights[0] - weights[1]}), 0);
      const Vec3d here = place(square, curve.face(piece), weights);
      ASSERT_LT((here - before).norm(), 2 / std::sqrt(kSteps));
      sum += here;
      before = here;
    }
  }
  // It passes equal areas in equal parts: the mean of its places is the square's middle.
  EXPECT_LT((sum / (2 * kSteps) - Vec3d(0.5, 0.5, 0)).norm(), 1e-3);
}

TEST(FaceCurve, EndsDividing) {
  const TriangleMesh square = testing::make_mesh(testing::square(1));
  EXPECT_EQ(FaceCurve(square, 1e-300).size(), 2U << FaceCurve::kMostHalvings);
}

}  // namespace
}  // namespace curvecast
