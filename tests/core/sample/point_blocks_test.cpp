#include "core/sample/point_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/particles.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

/// Whether list_near() and mark_near() miss nobody, for all points in turn; returns how many blocks they name for a point.
double expect_all_near(const std::vector<Particle>& particles, const PointBlocks& points, float reach) {
  PointBlocks::Scratch scratch;
  std::size_t named = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Particle& p = particles[i];
    points.list_near(points.box(i / PointBlocks::kBlock), reach, scratch);
    EXPECT_TRUE(std::is_sorted(scratch.near.begin(), scratch.near.end()));
    PointBlocks::mark_near(points.point(i), reach, scratch);
    std::vector<bool> is_named(points.block_count());
    for (std::size_t n = 0; n < scratch.near.size(); ++n) is_named[scratch.near[n]] = scratch.is_near[n] != 0;
    named += static_cast<std::size_t>(std::count(is_named.begin(), is_named.end(), true));
    for (std::size_t j = 0; j < particles.size(); ++j) {
      const float least = 0.999F * reach * std::min(p.spacing, particles[j].spacing);
      const bool is_near = (p.position - particles[j].position).norm() < least;
      EXPECT_TRUE(!is_near || is_named[j / PointBlocks::kBlock]) << i << " " << j;
    }
  }
  return static_cast<double>(named) / static_cast<double>(particles.size());
}

TEST(PointBlocks, MissesNobodyWhoIsNear) {
  for (const std::size_t n : {1u, 16u, 17u, 128u, 129u, 1500u}) {
    SCOPED_TRACE(n);
    const std::vector<Particle> particles = random_particles(n, 0.02F, 0.3F);
    expect_all_near(particles, blocks_of(particles), 1);
  }
}

TEST(PointBlocks, NamesFewOthers) {
  const std::vector<Particle> particles = random_particles(1500, 0.02F, 0.02F);
  EXPECT_LT(expect_all_near(particles, blocks_of(particles), 1), 8);  // of 94
}

TEST(PointBlocks, MissesNobodyAfterMoves) {
  std::vector<Particle> particles = random_particles(800, 0.05F, 0.3F);
  PointBlocks points = blocks_of(particles);
  for (std::size_t i = 0; i < particles.size(); i += 7) {
    particles[i].position = -particles[i].position;
    points.move(i, particles[i].position, particles[i].normal);
  }
  expect_all_near(particles, points, 1.5F);
}

TEST(PointBlocks, FillsTheLastBlockWithNobody) {
  const std::vector<Particle> particles = random_particles(17, 0.5F, 0.5F);
  const PointBlocks points = blocks_of(particles);
  ASSERT_EQ(points.block_count(), 2u);
  EXPECT_EQ(points.size_of(1), 1u);
  EXPECT_EQ(points.columns(1).spacing[0], 0.5F);
  EXPECT_EQ(points.columns(1).spacing[1], 0);
  EXPECT_EQ(points.box(1).low, particles[16].position);
  EXPECT_EQ(points.box(1).high, particles[16].position);
}

TEST(PointBlocks, TakesNone) { EXPECT_EQ(blocks_of({}).block_count(), 0u); }

}  // namespace
}  // namespace curvecast
