#include "server/frame/view_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/codec/position_bits.h"
#include "server/frame/session_sampler.h"
#include "tests/server/ball_session.h"

namespace curvecast::server {
namespace {

const Session& ball() {
  static const std::shared_ptr<const Session> session = make_session(2000);
  return *session;
}

ViewCache& cache() {
  static ViewCache cache;
  return cache;
}

Camera above(double distance) { return {.eye = Vec3d(0, 0, 1 + distance), .target = Vec3d::Zero()}; }

PointSetRequest request_from(std::vector<Camera> cameras, Sampler sampler, int bits = kAutomaticBits) {
  PointSetRequest request;
  request.sampler = sampler;
  request.options.points = 1500;
  request.options.density = Density({ScreenTerm{}}, std::move(cameras));
  request.draco = DracoOptions{.position_bits = bits};
  return request;
}

Sampled sampled(const PointSetRequest& request) {
  auto sampler = SessionSampler::open(ball(), request, cache(), SessionSampler::Wait::kForAll);
  EXPECT_TRUE(sampler.ok()) << sampler.status();
  auto points = sampler->sample(request.options.points);
  EXPECT_TRUE(points.ok()) << points.status();
  return *std::move(points);
}

TEST(ViewLattice, IsThatOfTheNearestPointWhicheverWayItIsFound) {
  for (const double distance : {4.0, 0.3, 0.01, 0.001}) {
    for (const Sampler sampler : {Sampler::kEqualised, Sampler::kProgressive}) {
      const PointSetRequest request = request_from({above(10), above(distance)}, sampler);
      const Sampled points = sampled(request);
      const Vec3d eye = request.options.density.cameras[1].eye;
      double nearest = HUGE_VAL;
      for (const Vec3f& p : points.points().positions) nearest = std::min(nearest, (p.cast<double>() - eye).norm());
      const LatticeNeed& need = points.need;
      EXPECT_NEAR((need.nearest - eye).norm(), nearest, 1e-6);
      EXPECT_NEAR(need.pixels * nearest, 1.3431 * 512 / std::tan(M_PI / 8), 1);
      EXPECT_EQ(need.best.bits, position_bits_for(need.pixels, 2));
      EXPECT_EQ(need.best, lattice_need(request, points.curve->box, points.points()).best);
      EXPECT_EQ(need.best.centre.has_value(), need.best.bits > kMostCornerBits);
      EXPECT_TRUE(need.is_met_by(need.best));
    }
  }
}

TEST(ViewLattice, FollowsTheHeightOfAnOrthographicPicture) {
  int before = 0;
  for (const double height : {2.0, 0.2, 0.02, 0.002}) {
    Camera camera = above(1);
    camera.height = height;
    const int bits = sampled(request_from({camera}, Sampler::kProgressive)).need.best.bits;
    EXPECT_GE(bits, before + 3);
    before = bits;
  }
}

TEST(ViewLattice, IsWhatTheClientAsksForOrAPlainOneWithoutACamera) {
  const Sampled fixed = sampled(request_from({above(0.001)}, Sampler::kProgressive, 13));
  EXPECT_EQ(fixed.lattice, ViewLattice({.bits = 13, .centre = {}}));
  EXPECT_FALSE(fixed.need.is_met_by({.bits = 16, .centre = {}}));
  PointSetRequest request = request_from({}, Sampler::kEqualised);
  request.options.density.terms.clear();
  EXPECT_EQ(sampled(request).lattice.bits, kPlainPositionBits);
  request.draco.reset();
  EXPECT_EQ(sampled(request).lattice, ViewLattice());
}

TEST(ViewLattice, ACentreDoesAsLongAsFloatsAboutItAreFineEnough) {
  const LatticeNeed near = sampled(request_from({above(0.0005)}, Sampler::kProgressive)).need;
  ASSERT_TRUE(near.best.centre);
  const auto centred = [&](double away) {
    return ViewLattice{.bits = near.best.bits, .centre = *near.best.centre + Vec3d(away, 0, 0)};
  };
  EXPECT_TRUE(near.is_met_by(centred(0)));
  EXPECT_TRUE(near.is_met_by(centred(1e-3)));
  EXPECT_FALSE(near.is_met_by(centred(2)));
  EXPECT_FALSE(near.is_met_by({.bits = 20, .centre = {}}));
  // From afar the same centre does wherever it is, and however many bits the points around it have.
  const LatticeNeed afar = sampled(request_from({above(0.02)}, Sampler::kProgressive)).need;
  EXPECT_TRUE(afar.is_met_by({.bits = afar.best.bits + 9, .centre = Vec3d(0, 0, -1)}));
}

TEST(ViewLattice, WhatIsAddedIsAsFineAsTheViewNeedsAndWhatIsHeldHardlyCoarser) {
  const LatticeNeed need = sampled(request_from({above(0.05)}, Sampler::kProgressive)).need;
  const auto corner = [](int bits) { return ViewLattice{.bits = bits, .centre = {}}; };
  for (int bits = kLeastPositionBits; bits <= kMostCornerBits; ++bits) {
    EXPECT_EQ(need.is_met_by(corner(bits)), bits >= need.best.bits - kMostMissingBits) << bits;
    EXPECT_EQ(need.beside(corner(bits)), corner(need.best.bits));
  }
  const ViewLattice centred{.bits = need.best.bits, .centre = Vec3d(1, 0, 0)};
  EXPECT_EQ(need.beside(centred), centred);
  // Floats that count from a corner are never finer than they can be.
  const LatticeNeed near = sampled(request_from({above(0.0005)}, Sampler::kProgressive)).need;
  ASSERT_GT(near.best.bits, kMostCornerBits);
  EXPECT_FALSE(near.is_met_by(corner(near.best.bits)));
}

TEST(ViewLattice, MovingTheOriginMovesNoPoint) {
  PointSet points;
  points.origin = Vec3d(1, 2, 3);
  points.positions = {Vec3f(0.5f, 0, -4), Vec3f(0.25f, 1, 8)};
  const ViewLattice lattice{.bits = 23, .centre = Vec3d(1.5, 2, -1)};
  for (int i = 0; i < 2; ++i) {
    move_origin(lattice, points);
    EXPECT_EQ(points.origin, *lattice.centre);
    EXPECT_EQ(points.positions, (std::vector<Vec3f>{Vec3f(0, 0, 0), Vec3f(-0.25f, 1, 12)}));
  }
  move_origin({.bits = 11, .centre = {}}, points);
  EXPECT_EQ(points.origin, *lattice.centre);
}

}  // namespace
}  // namespace curvecast::server
