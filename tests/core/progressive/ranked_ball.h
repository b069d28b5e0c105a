// A ball with ranked points on it, for tests of what selects among them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/curve_surface.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/rank_selection.h"
#include "tests/support/shapes.h"

namespace curvecast::testing {

inline const Preprocessed& ball() {
  static const Preprocessed preprocessed = [] {
    const std::string bytes = to_off(icosphere(4));
    absl::StatusOr<Preprocessed> done = preprocess({"ball.off", bytes}, {.points = 16'384});
    EXPECT_TRUE(done.ok()) << done.status();
    return *std::move(done);
  }();
  return preprocessed;
}
inline const std::shared_ptr<const SurfaceCurve>& ball_curve() { return ball().curve; }
inline const std::shared_ptr<const LeafSurface>& ball_surface() {
  static const std::shared_ptr<const LeafSurface> surface = leaf_surface(ball());
  return surface;
}

/// With the 4^level lowest ranks.
inline std::unique_ptr<RankGrower> ball_grower(int level, std::uint64_t seed = 0) {
  auto grower = RankGrower::make(ball_surface(), {.level = level, .seed = seed});
  EXPECT_TRUE(grower.ok()) << grower.status();
  return *std::move(grower);
}

inline std::shared_ptr<const RankTree> ball_tree(int level) { return ball_grower(level)->tree(); }

/// The silhouette term, seen from a place towards the ball's middle.
inline Density view_from(const Vec3d& eye, double s0 = 0.1) {
  return {{ViewTerm{.s0 = s0}}, {Camera{.eye = eye, .target = Vec3d::Zero(), .up = Vec3d(0.1, 1, 0.2)}}};
}

/// The ranks of the points that a selection shows, ascending.
inline std::vector<std::uint32_t> ranks_of(const RankSelection& selection) {
  std::vector<std::uint32_t> ranks;
  selection.for_each_shown([&](const RankRef& ref, std::size_t) {
    ranks.push_back(static_cast<std::uint32_t>(selection.chunk(ref).rank_of(ref.point)));
  });
  std::sort(ranks.begin(), ranks.end());
  return ranks;
}

}  // namespace curvecast::testing
