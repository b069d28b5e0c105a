#include "core/curve/curve_blocks.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <limits>
#include <vector>

#include "core/base/random.h"
#include "tests/core/refine/refined.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(CurveBlocks, HoldTheirVertices) {
  for (const auto& shape : refinable_shapes()) {
    const SurfaceCurve& curve = shape->curve();
    const CurveBlocks& blocks = curve.blocks;
    ASSERT_EQ(blocks.size(), block_count(curve.size()));
    for (std::size_t l = 0; l < curve.size(); ++l) {
      const std::size_t b = l / kBlockSize;
      EXPECT_LE((curve.position(l) - Vec3f(blocks.x[b], blocks.y[b], blocks.z[b])).norm(), blocks.radius[b]);
      EXPECT_LE((curve.normal(l) - Vec3f(blocks.nx[b], blocks.ny[b], blocks.nz[b])).norm(), blocks.spread[b]);
    }
    double sum = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      EXPECT_NEAR(Vec3f(blocks.nx[b], blocks.ny[b], blocks.nz[b]).norm(), 1, 1e-4);
      sum += static_cast<double>(blocks.area.sum[b]);
    }
    EXPECT_NEAR(sum / curve.total_area, 1, 1e-5);
  }
}

TEST(CurveBlocks, AreTheSameForAnyNumberOfThreads) {
  const auto shape = refinable(torus(60, 30), 3000);
  const auto blocks_with = [&](int threads) {
    return tbb::task_arena(threads).execute([&] { return build_blocks(shape->curve()); });
  };
  const CurveBlocks one = blocks_with(1), four = blocks_with(4);
  EXPECT_EQ(one.x, four.x);
  EXPECT_EQ(one.radius, four.radius);
  EXPECT_EQ(one.spread, four.spread);
  EXPECT_EQ(one.area.sum, four.area.sum);
}

TEST(SumBlocks, GiveEveryVertexItsPart) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    float mass[kBlockSize][kBlockLanes] = {};
    const std::size_t n = 1 + seed % kBlockSize;
    for (std::size_t k = 0; k < kBlockLanes; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::uint64_t number = seed * kBlockLanes + k;
        mass[i][k] = random_unit(number, i) < 0.3 && i != number % n ? 0 : static_cast<float>(random_unit(number, 100 + i));
      }
    }
    MassOfBlocks blocks;
    sum_blocks(mass, blocks);
    for (std::size_t k = 0; k < kBlockLanes; ++k) {
      double sum = 0;
      float largest = 0;
      for (const auto& of_vertex : mass) sum += static_cast<double>(of_vertex[k]), largest = std::max(largest, of_vertex[k]);
      EXPECT_NEAR(blocks.sum[k], sum, 1e-6 * sum);
      EXPECT_EQ(blocks.largest[k], largest);
      for (const float part : {0.0f, 0.1f, 0.5f, 0.77f, 0.999f, 0x1.fffffep-1f}) {
        const std::size_t v = blocks.codes[k].vertex(MassCodes::part(part));
        ASSERT_LT(v, n);
        ASSERT_GT(mass[v][k], 0);
        double below = 0;
        for (std::size_t i = 0; i < v; ++i) below += static_cast<double>(mass[i][k]);
        const double code = 1.01 * sum / MassCodes::kWhole;
        EXPECT_LE(below, part * sum + code);
        EXPECT_GT(below + static_cast<double>(mass[v][k]), part * sum - code);
      }
    }
  }
}

TEST(SumBlocks, StandNoMassAndTooMuch) {
  float mass[kBlockSize][kBlockLanes] = {};
  mass[0][1] = mass[1][1] = std::numeric_limits<float>::max();
  MassOfBlocks blocks;
  sum_blocks(mass, blocks);
  EXPECT_EQ(blocks.sum[0], 0);
  EXPECT_FALSE(std::isfinite(blocks.sum[1]));
}

}  // namespace
}  // namespace curvecast
