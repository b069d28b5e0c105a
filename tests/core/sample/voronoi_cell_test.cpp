#include "core/sample/voronoi_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/particles.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

const Vec3f kUp = Vec3f::UnitZ();

/// In the order of `particles`.
std::vector<VoronoiCell> cells_of(const std::vector<Particle>& particles) {
  const PointBlocks points = blocks_of(particles);
  PointBlocks::Scratch scratch;
  std::vector<VoronoiCell> cells;
  for (std::size_t b = 0; b < points.block_count(); ++b) {
    points.list_near(points.box(b), kCellReach, scratch, kCellLeast);
    for (std::size_t k = 0; k < points.size_of(b); ++k)
      cells.push_back(voronoi_cell(points, b * PointBlocks::kBlock + k, scratch));
  }
  return cells;
}

/// The area of the polygon through the ends of a circle's directions.
float circle(float radius) { return 8 * std::sin(static_cast<float>(M_PI) / 8) * radius * radius; }

/// On a plane, in rows.
std::vector<Particle> plane(std::size_t n, float least_spacing, float most_spacing) {
  std::minstd_rand random(7);
  std::uniform_real_distribution<float> jitter(-0.45F, 0.45F), spacing(least_spacing, most_spacing);
  std::vector<Particle> particles;
  for (std::size_t i = 0; i < n * n; ++i) {
    const auto x = static_cast<float>(i % n) + jitter(random), y = static_cast<float>(i / n) + jitter(random);
    particles.push_back({{x, y, 0}, kUp, spacing(random)});
  }
  return particles;
}

/// How far the cell goes in a direction, pair by pair.
double by_definition(const std::vector<Particle>& particles, std::size_t i, const Vec3d& direction) {
  const Particle& p = particles[i];
  double radius = kCellRadius * double{p.spacing};
  const double reach = 2 * radius;
  for (std::size_t j = 0; j < particles.size(); ++j) {
    const Vec3d to = (particles[j].position - p.position).cast<double>();
    if (j == i || to.norm() >= reach || !(to.dot(direction) > 0)) continue;
    const double part = double{p.spacing} / (double{p.spacing} + double{particles[j].spacing});
    radius = std::min(radius, part * to.squaredNorm() / to.dot(direction));
  }
  return radius;
}

void expect_definition(const std::vector<Particle>& particles) {
  const std::vector<VoronoiCell> cells = cells_of(particles);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    std::array<Vec3d, VoronoiCell::kDirections> ends;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      const Vec3d direction = cells[i].direction(k).cast<double>();
      ends[k] = by_definition(particles, i, direction) * direction;
    }
    double area = 0;
    Vec3d moment = Vec3d::Zero();
    for (std::size_t k = 0, before = ends.size() - 1; k < ends.size(); before = k++) {
      const double triangle = ends[before].cross(ends[k]).z() / 2;
      area += triangle;
      moment += triangle / 3 * (ends[before] + ends[k]);
    }
    const double spacing = particles[i].spacing;
    ASSERT_NEAR(double{cells[i].area()}, area, 1e-4 * spacing * spacing) << i;
    ASSERT_LT((cells[i].centre().cast<double>() - moment / area).norm(), 1e-4 * spacing) << i;
  }
}

TEST(VoronoiCellTest, IsWhatNoOtherPointHasMoreOfARightTo) { expect_definition(plane(20, 1, 1)); }

TEST(VoronoiCellTest, IsLargerWhereTheSpacingIs) { expect_definition(plane(20, 0.6F, 1.5F)); }

TEST(VoronoiCellTest, OfALatticeHasItsPointForCentre) {
  std::vector<Particle> particles;
  const float row = std::sqrt(0.75F);
  for (int i = 0; i < 400; ++i) {
    particles.push_back(
        {{static_cast<float>(i % 20) + (i / 20 % 2 == 0 ? 0 : 0.5F), row * static_cast<float>(i / 20), 0}, kUp, 1});
  }
  const std::vector<VoronoiCell> cells = cells_of(particles);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i % 20 < 3 || i % 20 > 16 || i / 20 < 3 || i / 20 > 16) continue;
    EXPECT_NEAR(cells[i].area(), row, 0.05F);  // but for its corners
    EXPECT_LT(cells[i].centre().norm(), 1e-5F);
  }
}

TEST(VoronoiCellTest, OfOneAloneIsACircleInItsPlane) {
  const Vec3f normal = Vec3f(1, 2, -3).normalized();
  const VoronoiCell cell = cells_of({{{1, 2, 3}, normal, 2}})[0];
  EXPECT_NEAR(cell.area(), circle(2 * kCellRadius), 1e-4F);
  EXPECT_LT(cell.centre().norm(), 1e-6F);
  for (std::size_t k = 0; k < VoronoiCell::kDirections; ++k) {
    EXPECT_NEAR(cell.direction(k).norm(), 1, 1e-6F);
    EXPECT_NEAR(cell.direction(k).dot(normal), 0, 1e-6F);
    EXPECT_NEAR(cell.direction(k).dot(cell.direction((k + 4) % VoronoiCell::kDirections)), 0, 1e-6F);
  }
}

TEST(VoronoiCellTest, IsCutByAnyLine) {
  VoronoiCell cell(kUp, 1);
  cell.cut(2 * cell.direction(3), 0.25F);
  const float left = cell.area();
  EXPECT_LT(left, 0.85F * circle(1));
  EXPECT_LT(cell.centre().dot(cell.direction(3)), -0.1F);
  EXPECT_LT(std::abs(cell.centre().dot(cell.direction(7))), 1e-6F);
  cell.cut(Vec3f::Zero(), 1);  // of no direction
  cell.cut(5 * cell.direction(3), 0.25F);
  EXPECT_EQ(cell.area(), left);
  cell.cut(-0.5F * cell.direction(3), 1);
  EXPECT_LT(cell.centre().norm(), 1e-6F);
}

TEST(VoronoiCellTest, KnowsNothingOfWhatFacesAway) {
  const std::vector<VoronoiCell> cells = cells_of({{{0, 0, 0}, kUp, 1}, {{0.1F, 0, -0.1F}, -kUp, 1}, {{0.5F, 0, 0}, kUp, 1}});
  EXPECT_NEAR(cells[1].area(), circle(kCellRadius), 1e-4F);
  EXPECT_LT(cells[0].area(), circle(kCellRadius) / 2 + 2 * kCellRadius * 0.25F);
  EXPECT_NEAR(cells[0].centre().x(), -cells[2].centre().x(), 1e-6F);
}

TEST(VoronoiCellTest, SeesWhatIsSmallFromAfar) {
  // What is denser takes its part of a large cell, too, though that is far beyond the small one's own reach.
  const std::vector<VoronoiCell> cells = cells_of({{{0, 0, 0}, kUp, 10}, {{7, 0, 0}, kUp, 0.1F}});
  EXPECT_LT(cells[0].area(), circle(10 * kCellRadius) - 1);
  EXPECT_NEAR(cells[1].area(), circle(0.1F * kCellRadius), 1e-4F);
}

TEST(VoronoiCellTest, IsTheSameAtAnyScale) {
  const std::vector<Particle> particles = plane(10, 0.8F, 1.2F);
  const std::vector<VoronoiCell> cells = cells_of(particles);
  for (const float scale : {0x1p-50F, 0x1p40F}) {
    std::vector<Particle> scaled = particles;
    for (Particle& p : scaled) p = {scale * p.position, p.normal, scale * p.spacing};
    const std::vector<VoronoiCell> others = cells_of(scaled);
    for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_EQ(others[i].centre(), Vec3f(scale * cells[i].centre())) << i;
  }
}

TEST(VoronoiCellTest, TakesAnything) {
  EXPECT_EQ(cells_of({{{0, 0, 0}, Vec3f::Zero(), 1}, {{0.5, 0, 0}, kUp, 1}})[0].centre(), Vec3f::Zero());
  for (const VoronoiCell& cell : cells_of(std::vector<Particle>(300, {{0, 0, 0}, kUp, 1}))) {  // all at one place
    EXPECT_LT(cell.centre().norm(), 1e-6F);
  }
  std::vector<Particle> particles = {{{0, 0, 0}, kUp, 1}};  // a circle of them
  for (int i = 0; i < 2000; ++i) {
    const auto angle = static_cast<float>(2 * M_PI / 2000 * i);
    particles.push_back({{std::cos(angle), std::sin(angle), 0}, kUp, 1});
  }
  const VoronoiCell cell = cells_of(particles)[0];
  EXPECT_NEAR(cell.area(), circle(0.5F), 1e-4F);
  EXPECT_LT(cell.centre().norm(), 1e-4F);
  for (const VoronoiCell& any : cells_of(random_particles(3000, 0.01F, 0.8F))) {
    EXPECT_TRUE(any.centre().allFinite());
    EXPECT_GE(any.area(), 0);
  }
}

}  // namespace
}  // namespace curvecast
