#include "core/sample/overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/particles.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

const Vec3f kUp(0, 0, 1);
constexpr float kBehind = 0.4F;

struct Found {
  std::vector<Vec3f> steps;
  std::vector<bool> is_found;
  std::vector<std::uint8_t> wakes;
};

Found find_all(const std::vector<Particle>& particles, const std::vector<std::uint8_t>& is_awake, float behind = kBehind) {
  const PointBlocks points = blocks_of(particles);
  Found found{{}, {}, std::vector<std::uint8_t>(particles.size())};
  PointBlocks::Scratch scratch;
  for (std::size_t b = 0; b < points.block_count(); ++b) {
    const Overlap overlap = find_overlap(points, b, behind, is_awake, found.wakes, scratch);
    for (std::size_t k = 0; k < points.size_of(b); ++k) {
      found.steps.push_back(overlap.steps[k]);
      found.is_found.push_back(overlap.is_found[k]);
    }
  }
  return found;
}

Found find_all(const std::vector<Particle>& particles, float behind = kBehind) {
  return find_all(particles, std::vector<std::uint8_t>(particles.size(), 1), behind);
}

/// How near two points may be.
float least(const Particle& p, const Particle& q) {
  const float alike = std::clamp(1 + 2 * p.normal.dot(q.normal), 0.0F, 1.0F);
  return (kBehind + (kApart - kBehind) * alike) * std::min(p.spacing, q.spacing);
}

TEST(Overlap, FindsAllPairsThatAreTooNear) {
  const std::vector<Particle> particles = random_particles(1'000, 0.05F, 0.4F);
  const Found found = find_all(particles);
  std::size_t count = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    bool expected = false, is_close_call = false;
    for (std::size_t j = 0; j < particles.size(); ++j) {
      if (i == j) continue;
      const float part = (particles[i].position - particles[j].position).norm() / least(particles[i], particles[j]);
      expected |= part < 1;
      is_close_call |= std::abs(part - 1) < 1e-4F;
    }
    if (is_close_call) continue;
    EXPECT_EQ(found.is_found[i], expected) << i;
    EXPECT_EQ(found.wakes[i] != 0, expected) << i;
    EXPECT_EQ(found.steps[i] == Vec3f(Vec3f::Zero()), !expected) << i;
    count += expected;
  }
  EXPECT_GT(count, 100u);
  EXPECT_LT(count, 900u);
}

TEST(Overlap, PartsPairsAtOnce) {
  for (const float d : {0.01F, 0.3F, 0.7F}) {
    std::vector<Particle> pair = {{{0, 0, 0}, kUp, 1}, {{d, 0, 0}, kUp, 2}};
    const Found found = find_all(pair);
    for (std::size_t i = 0; i < 2; ++i) pair[i].position += found.steps[i];
    const float apart = (pair[0].position - pair[1].position).norm();
    EXPECT_GT(apart, kApart);
    EXPECT_LT(apart, 1.05F * kApart);
    EXPECT_FALSE(find_all(pair).is_found[0]);
  }
}

TEST(Overlap, StepsStayInTheirPlanes) {
  // One point stands above the other: only a way aside helps.
  std::vector<Particle> pair = {{{0, 0, 0}, kUp, 1}, {{0.1F, 0, 0.5F}, kUp, 1}};
  const Found found = find_all(pair);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found.steps[i].z(), 0);
    pair[i].position += found.steps[i];
  }
  EXPECT_GT((pair[0].position - pair[1].position).norm(), kApart);
}

TEST(Overlap, AsksForLessOfWhatIsBehind) {
  const std::vector<Particle> sheet = {{{0, 0, 0}, kUp, 1}, {{0.5F, 0, -0.1F}, -kUp, 1}};
  EXPECT_FALSE(find_all(sheet, 0.45F).is_found[0]);
  EXPECT_TRUE(find_all(sheet, kApart).is_found[0]);
  PointBlocks::Scratch scratch;
  EXPECT_EQ(count_too_near_behind(blocks_of(sheet), 0, scratch), 2u);
  const std::vector<Particle> beside = {{{0, 0, 0}, kUp, 1}, {{0.5F, 0, 0}, kUp, 1}, {{2, 0, 0}, -kUp, 1}};
  EXPECT_EQ(count_too_near_behind(blocks_of(beside), 0, scratch), 0u);
}

TEST(Overlap, LooksOnlyAtThoseAwake) {
  const std::vector<Particle> row = {{{0, 0, 0}, kUp, 1}, {{0.5F, 0, 0}, kUp, 1}, {{1, 0, 0}, kUp, 1}, {{9, 0, 0}, kUp, 1}};
  const Found found = find_all(row, {1, 0, 0, 1});
  EXPECT_EQ(found.is_found, (std::vector<bool>{true, false, false, false}));
  EXPECT_EQ(found.wakes, (std::vector<std::uint8_t>{1, 1, 0, 0}));
  EXPECT_EQ(found.steps[1], Vec3f(Vec3f::Zero()));
}

TEST(Overlap, LeavesAloneWhatIsAtTheSamePlace) {
  const Found found = find_all({{{1, 2, 3}, kUp, 1}, {{1, 2, 3}, kUp, 1}});
  EXPECT_FALSE(found.is_found[0]);
  EXPECT_EQ(found.steps[0], Vec3f(Vec3f::Zero()));
}

}  // namespace
}  // namespace curvecast
