#include "client/bench/peers/samplings.h"

#include <gtest/gtest.h>

#include <string>

#include "client/bench/peers/ring_test.h"
#include "core/mesh/triangle_distance.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

Sampler torus_sampler(std::uint64_t most_points) {
  static const std::string kOff = curvecast::testing::to_off(curvecast::testing::torus(24, 12));
  absl::StatusOr<Preprocessed> made = preprocess({"torus.off", kOff}, {.points = most_points});
  EXPECT_TRUE(made.ok()) << made.status();
  return {*std::move(made), {}, most_points, 1};
}

TEST(Samplings, AllMakeExactlyNPointsOnTheirFaces) {
  Sampler sampler = torus_sampler(2000);
  const Preprocessed& made = sampler.preprocessed();
  const TriangleMesh& mesh = made.flattened->loaded.mesh;
  for (const Sampling& sampling : kSamplings) {
    for (const std::uint64_t n : {2u, 500u, 2000u}) {
      const auto set = sampler.sample(sampling, n, {});
      ASSERT_TRUE(set.ok()) << sampling.name << set.status();
      ASSERT_EQ(set->points.size(), n) << sampling.name;
      ASSERT_EQ(set->points.normals.size(), n) << sampling.name;
      if (sampling.kind == Sampling::kFarthest) continue;
      ASSERT_EQ(set->faces.size(), n) << sampling.name;
      for (std::size_t i = 0; i < n; ++i) {
        const Triangle& t = mesh.triangles[set->faces[i]];
        const Vec3d p = set->points.origin + set->points.positions[i].cast<double>();
        // Points of the curve may lie anywhere in their leaf, which reaches into faces around that of its middle.
        const double reach = follows_density(sampling.kind) ? 0.1 : 1e-5;
        ASSERT_LT(triangle_distance(p, mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]), reach) << sampling.name;
      }
    }
  }
}

TEST(Samplings, RandomOnesAreOthersForEveryNumber) {
  Sampler sampler = torus_sampler(500);
  const auto few = sampler.sample(kRandomSampling, 400, {}), more = sampler.sample(kRandomSampling, 500, {});
  EXPECT_NE(few->points.positions[0], more->points.positions[0]);
  EXPECT_EQ(few->points.positions, sampler.sample(kRandomSampling, 400, {})->points.positions);
}

TEST(RingTest, TellsRandomPointsFromEvenOnes) {
  constexpr std::uint64_t kMost = 20'000;
  Sampler sampler = torus_sampler(kMost);
  const std::vector<double> sizes = ring_set_sizes(kMost);
  const auto gradient = [&](const Sampling& sampling) {
    const auto test = ring_test(sampler, sampling, sizes, {}, {});
    EXPECT_TRUE(test.ok()) << test.status();
    EXPECT_EQ(test->rms.size(), sizes.size());
    return test->rms_gradient;
  };
  EXPECT_NEAR(gradient(kRandomSampling), -0.5, 0.05);
  EXPECT_LT(gradient(kJitteredSampling), -0.65);
  EXPECT_LT(gradient(kProgressiveSampling), -0.65);
}

}  // namespace
}  // namespace curvecast::cli::bench
