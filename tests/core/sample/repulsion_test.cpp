#include "core/sample/repulsion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/particles.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// The definition, pair by pair.
Vec3d push_by_definition(const std::vector<Particle>& particles, std::size_t i) {
  Vec3d sum = Vec3d::Zero();
  for (std::size_t j = 0; j < particles.size(); ++j) {
    const Vec3d apart = (particles[i].position - particles[j].position).cast<double>();
    const double d = apart.norm(), reach = 2 * static_cast<double>(std::min(particles[i].spacing, particles[j].spacing));
    if (i == j || d >= reach || d == 0) continue;
    const double alike = std::clamp(1 + 2 * double{particles[i].normal.dot(particles[j].normal)}, 0.0, 1.0);
    sum += alike * (1 - d / reach) * (1 - d / reach) / d * apart;
  }
  return sum;
}

void expect_definition(const std::vector<Particle>& particles) {
  const PointBlocks points = blocks_of(particles);
  PointBlocks::Scratch scratch;
  double most = 0;
  for (std::size_t b = 0; b < points.block_count(); ++b) {
    const auto pushes = repulsion(points, b, scratch);
    for (std::size_t k = 0; k < points.size_of(b); ++k) {
      const Vec3d expected = push_by_definition(particles, b * PointBlocks::kBlock + k);
      EXPECT_LT((pushes[k].cast<double>() - expected).norm(), 1e-4 * (1 + expected.norm())) << b << " " << k;
      most = std::max(most, expected.norm());
    }
  }
  EXPECT_TRUE(most > 0.1 || particles.size() < 100);
}

TEST(RepulsionTest, IsTheSumOverAllPairs) {
  for (const std::size_t n : {2u, 15u, 16u, 17u, 129u, 1000u}) {
    SCOPED_TRACE(n);
    expect_definition(random_particles(n, 0.5F, 0.7F));
  }
}

TEST(RepulsionTest, IsTheSumOverAllPairsWhereSpacingsDiffer) { expect_definition(random_particles(2000, 0.01F, 1.0F)); }

TEST(RepulsionTest, PushesPairsApartWithEqualForce) {
  const std::vector<Particle> particles = {{{0, 0, 0}, {0, 0, 1}, 1}, {{0.5, 0, 0}, {0, 0, 1}, 3}};
  PointBlocks::Scratch scratch;
  const auto pushes = repulsion(blocks_of(particles), 0, scratch);
  EXPECT_NEAR(pushes[0].x(), -0.5625F, 1e-6);  // (1 - 0.5 / 2)^2
  EXPECT_EQ(pushes[0], -pushes[1]);
}

TEST(RepulsionTest, LeavesAloneWhatFacesElsewhereOrIsAtTheSamePlace) {
  const std::vector<Particle> sides = {{{0, 0, 0}, {0, 0, 1}, 1}, {{0, 0, -0.1F}, {0, 0, -1}, 1}};
  const std::vector<Particle> same = {{{1, 2, 3}, {0, 0, 1}, 1}, {{1, 2, 3}, {0, 0, 1}, 1}};
  for (const auto& particles : {sides, same}) {
    PointBlocks::Scratch scratch;
    const auto pushes = repulsion(blocks_of(particles), 0, scratch);
    EXPECT_EQ(pushes[0], Vec3f(Vec3f::Zero()));
    EXPECT_EQ(pushes[1], Vec3f(Vec3f::Zero()));
  }
}

}  // namespace
}  // namespace curvecast
