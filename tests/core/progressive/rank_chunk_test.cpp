#include "core/progressive/rank_chunk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "core/progressive/progressive.h"
#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

constexpr int kLevel = 8;

const ProgressiveRanks& ranks() {
  static const ProgressiveRanks made = *ProgressiveRanks::make(ball_surface(), {.level = kLevel});
  return made;
}

/// Calls visit(id, the points of the chunk's level in its stratum, the chunk) for the first chunks down to kLevel.
template <typename Visit>
void for_each_chunk(const Visit& visit) {
  const CurveStrata strata(*ball_surface());
  const StratumBounds bounds(strata);
  for (int level = kChunkLevels; level <= kLevel; ++level) {
    const std::uint64_t count = std::uint64_t{1} << 2 * (level - kChunkLevels);
    for (std::uint64_t i = 0; i < count; ++i) {
      std::vector<RankedPoint> points;
      const std::size_t size = ranks().points().size() / count;
      for (const RankedPoint& p : ranks().points().subspan(i * size, size)) {
        if (p.rank < std::uint64_t{1} << 2 * level) points.push_back(p);
      }
      const ChunkId id{level, i};
      visit(id, std::span<const RankedPoint>(points), make_chunk(id, points, bounds, *ball_surface()));
    }
  }
}

TEST(RankChunk, HasThePointsThatItsLevelAdds) {
  for_each_chunk([](const ChunkId& id, std::span<const RankedPoint> points, const RankChunk& chunk) {
    ASSERT_EQ(points.size(), kChunkStrata);
    ASSERT_EQ(chunk.size(), id.level == kChunkLevels ? kChunkStrata : kChunkStrata / 4 * 3);
    std::size_t found = 0;
    for (std::size_t stratum = 0; stratum < kChunkStrata; ++stratum) {
      const RankedPoint& p = points[stratum];
      if (p.rank < id.first_rank()) continue;
      // Four strata of the chunk's level are one of a layer.
      const std::size_t layer = (p.rank - id.first_rank()) >> 2 * (id.level - 1), i = layer * kLayerStrata + stratum / 4;
      ASSERT_LT(layer, chunk.layers());
      ASSERT_GE(p.rank, id.first_rank(layer));
      ASSERT_EQ(chunk.rank[i], p.rank);
      ASSERT_EQ(Vec3f(chunk.x[i], chunk.y[i], chunk.z[i]), Vec3f(p.position[0], p.position[1], p.position[2]));
      ASSERT_LT((Vec3f(chunk.nx[i], chunk.ny[i], chunk.nz[i]) - Vec3f(p.normal[0], p.normal[1], p.normal[2])).norm(), 1e-4f);
      ASSERT_EQ(chunk.vertex[i], p.vertex);
      ASSERT_EQ(chunk.curve_position[i], p.curve_position);
      ASSERT_EQ(chunk.face[i], p.face);
      ASSERT_NEAR(chunk.weight_1[i], p.weight_1, 1e-5);
      ASSERT_NEAR(chunk.weight_2[i], p.weight_2, 1e-5);
      ++found;
    }
    ASSERT_EQ(found, chunk.size());
  });
}

TEST(RankChunk, KnowsThePictureDetailAtItsPoints) {
  const PictureDetail detail(*ball_curve());
  for_each_chunk([&](const ChunkId& id, std::span<const RankedPoint>, const RankChunk& chunk) {
    ASSERT_EQ(chunk.detail.size(), chunk.size());
    for (std::size_t i = 0; i < chunk.size(); ++i) ASSERT_NEAR(chunk.detail[i], detail.at(chunk.vertex[i]), 1e-5);
    const std::uint64_t runs = kChunkRuns << 2 * (id.level - kChunkLevels);
    const std::size_t length = ranks().points().size() / runs;
    for (std::size_t r = 0; r < kChunkRuns; ++r) {
      for (const RankedPoint& p : ranks().points().subspan((id.index * kChunkRuns + r) * length, length)) {
        ASSERT_LE(detail.at(p.vertex), chunk.bounds.detail[r]);
      }
    }
  });
}

TEST(RankChunk, KnowsWhatLiesBesideCreasesWhereThatIsAnything) {
  SurfaceCurve curve = *ball_curve();
  std::size_t with = 0, without = 0;
  for_each_chunk([&](const ChunkId&, std::span<const RankedPoint>, RankChunk chunk) {
    EXPECT_TRUE(chunk.beside.empty());
    EXPECT_EQ(chunk.runs_beside, 0);
    if (curve.beside.empty()) {
      curve.beside.resize(curve.size());
      for (std::size_t l = 0; l < curve.size(); ++l) {
        curve.beside[l] = curve.z[l] > 0.4F ? Direction8(Vec3f(0, 0, -1)) : Direction8{};
      }
    }
    fill_from_curve(curve, chunk);
    std::uint16_t runs = 0;
    for (std::size_t i = 0; i < chunk.size(); ++i) {
      if (curve.beside[chunk.vertex[i]].is_none()) continue;
      runs |= static_cast<std::uint16_t>(1 << i % kLayerStrata / kRunPoints);
    }
    EXPECT_EQ(chunk.runs_beside, runs);
    ASSERT_EQ(chunk.beside.size(), runs == 0 ? 0 : chunk.size());
    for (std::size_t i = 0; i < chunk.beside.size(); ++i) EXPECT_EQ(chunk.beside[i], curve.beside[chunk.vertex[i]]);
    ++(runs == 0 ? without : with);
  });
  EXPECT_GT(with, 0u);
  EXPECT_GT(without, 0u);
}

TEST(RankChunk, RunsAreBoundedWithTheirDeeperPoints) {
  for_each_chunk([](const ChunkId& id, std::span<const RankedPoint>, const RankChunk& chunk) {
    // All points of the whole set in a run's strata, of whatever level.
    const std::uint64_t runs = kChunkRuns << 2 * (id.level - kChunkLevels);
    const std::size_t length = ranks().points().size() / runs;
    for (std::size_t r = 0; r < kChunkRuns; ++r) {
      const Vec3f centre(chunk.bounds.x[r], chunk.bounds.y[r], chunk.bounds.z[r]);
      for (const RankedPoint& p : ranks().points().subspan((id.index * kChunkRuns + r) * length, length)) {
        ASSERT_LE((Vec3f(p.position[0], p.position[1], p.position[2]) - centre).norm(), chunk.bounds.radius[r]);
        ASSERT_GE(p.vertex, chunk.first_vertex[r]);
        ASSERT_LE(p.vertex, chunk.last_vertex[r]);
      }
      // The chunk's own points of the run lie in its strata.
      for (std::size_t i = 0; i < chunk.size(); ++i) {
        if (i % kLayerStrata / kRunPoints != r) continue;
        ASSERT_GE(chunk.vertex[i], chunk.first_vertex[r]);
        ASSERT_LE(chunk.vertex[i], chunk.last_vertex[r]);
      }
    }
  });
}

}  // namespace
}  // namespace curvecast
