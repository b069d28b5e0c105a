#include "core/sample/repulsion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace curvecast {
namespace {

struct Particle {
  Vec3f position, normal;
  float spacing;
};

std::vector<Particle> random_particles(std::size_t n, float least, float most) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> place(-1, 1), spacing(least, most);
  std::vector<Particle> particles;
  for (std::size_t i = 0; i < n; ++i) {
    const auto vector = [&] { return Vec3f(place(generator), place(generator), place(generator)); };
    const Vec3f position = vector();
    particles.push_back({position, vector().normalized(), spacing(generator)});
  }
  // Neighbours follow one another only roughly: blocks overlap.
  std::sort(particles.begin(), particles.end(),
            [](const Particle& a, const Particle& b) { return a.position.x() < b.position.x(); });
  return particles;
}

Repulsion repulsion_of(const std::vector<Particle>& particles) {
  Repulsion repulsion(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    repulsion.set(i, particles[i].position, particles[i].normal, particles[i].spacing);
  }
  repulsion.fill_boxes();
  return repulsion;
}

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
  const Repulsion repulsion = repulsion_of(particles);
  Repulsion::Scratch scratch;
  double most = 0;
  for (std::size_t b = 0; b < repulsion.block_count(); ++b) {
    const auto pushes = repulsion.find(b, scratch);
    for (std::size_t k = 0; k < Repulsion::kBlock && b * Repulsion::kBlock + k < particles.size(); ++k) {
      const Vec3d expected = push_by_definition(particles, b * Repulsion::kBlock + k);
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
  Repulsion::Scratch scratch;
  const auto pushes = repulsion_of(particles).find(0, scratch);
  EXPECT_NEAR(pushes[0].x(), -0.5625F, 1e-6);  // (1 - 0.5 / 2)^2
  EXPECT_EQ(pushes[0], -pushes[1]);
}

TEST(RepulsionTest, LeavesAloneWhatFacesElsewhereOrIsAtTheSamePlace) {
  const std::vector<Particle> sides = {{{0, 0, 0}, {0, 0, 1}, 1}, {{0, 0, -0.1F}, {0, 0, -1}, 1}};
  const std::vector<Particle> same = {{{1, 2, 3}, {0, 0, 1}, 1}, {{1, 2, 3}, {0, 0, 1}, 1}};
  for (const auto& particles : {sides, same}) {
    Repulsion::Scratch scratch;
    const auto pushes = repulsion_of(particles).find(0, scratch);
    EXPECT_EQ(pushes[0], Vec3f(Vec3f::Zero()));
    EXPECT_EQ(pushes[1], Vec3f(Vec3f::Zero()));
  }
}

TEST(RepulsionTest, KnowsTheNearest) {
  std::vector<Particle> particles = random_particles(500, 0.05F, 0.3F);
  Repulsion repulsion = repulsion_of(particles);
  // Some have moved since the boxes were filled.
  for (std::size_t i = 0; i < particles.size(); i += 7) {
    particles[i].position = -particles[i].position;
    repulsion.move(i, particles[i].position, particles[i].normal);
  }
  Repulsion::Scratch scratch;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Particle& p = particles[i];
    Repulsion::Nearest expected;
    for (std::size_t j = 0; j < particles.size(); ++j) {
      if (j == i) continue;
      const Particle& q = particles[j];
      const float distance = (p.position - q.position).norm() / std::min(p.spacing, q.spacing);
      expected.at_all = std::min(expected.at_all, distance);
      if (1 + 2 * p.normal.dot(q.normal) > 0) expected.on_side = std::min(expected.on_side, distance);
    }
    const Repulsion::Nearest found = repulsion.nearest(i, p.position, p.normal, scratch);
    EXPECT_EQ(found.on_side, expected.on_side) << i;
    EXPECT_EQ(found.at_all, expected.at_all) << i;
    differ += found.on_side != found.at_all;
  }
  EXPECT_GT(differ, 10u);
}

TEST(RepulsionTest, TakesNone) { EXPECT_EQ(repulsion_of({}).block_count(), 0u); }

}  // namespace
}  // namespace curvecast
