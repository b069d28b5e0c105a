#include "client/bench/peers/triangle_random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/measure/gradient.h"
#include "core/measure/ring_discrepancy.h"
#include "core/mesh/triangle_distance.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

TEST(TriangleRandom, GivesEachFaceItsShareRoundedDownOrUp) {
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::torus(12, 8));
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{192}, std::size_t{100'001}}) {
    const SurfacePoints points = triangle_random_points(mesh, n, 3);
    ASSERT_EQ(points.faces.size(), n);
    ASSERT_EQ(points.positions.size(), n);
    std::vector<double> count(mesh.face_count());
    for (std::size_t i = 0; i < n; ++i) {
      const Triangle& t = mesh.triangles[points.faces[i]];
      ASSERT_LT(triangle_distance(points.positions[i], mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]), 1e-12);
      ++count[points.faces[i]];
    }
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      EXPECT_LT(std::abs(count[f] - static_cast<double>(n) * triangle_area(mesh, f) / surface_area(mesh)), 1 + 1e-9);
    }
  }
}

TEST(TriangleRandom, GivesWhatIsLeftOverByChance) {
  // Of two points for three faces of one size and a fourth as large as two, over many seeds: shares in proportion.
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::soup_of(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {2, -1, 0}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {1, 4, 5}}));
  std::vector<double> count(mesh.face_count());
  constexpr int kRuns = 4000;
  for (int seed = 0; seed < kRuns; ++seed) {
    for (const std::uint32_t f : triangle_random_points(mesh, 2, static_cast<std::uint64_t>(seed)).faces) ++count[f];
  }
  for (std::size_t f = 0; f < count.size(); ++f) {
    EXPECT_NEAR(count[f] / kRuns, 2 * triangle_area(mesh, f) / surface_area(mesh), 0.04) << f;
  }
}

TEST(TriangleRandom, AsFewPointsAsFacesFallAsRandomOnesDo) {
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::icosphere(5));
  const std::vector<double> sizes = ring_set_sizes(mesh.face_count() / 4);
  std::vector<std::vector<std::uint32_t>> sets;
  for (const double n : sizes) sets.push_back(triangle_random_points(mesh, static_cast<std::size_t>(n), sets.size()).faces);
  std::vector<double> rms;
  for (const Discrepancy& d : ring_discrepancy(mesh, sets)) rms.push_back(d.rms);
  EXPECT_NEAR(log_log_gradient(sizes, rms), -0.5, 0.08);
}

}  // namespace
}  // namespace curvecast::cli::bench
