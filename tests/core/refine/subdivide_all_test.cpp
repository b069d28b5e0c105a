#include "core/refine/subdivide_all.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "tests/core/refine/refined.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(SubdivideAll, DividesEveryLeaf) {
  for (const auto& shape : refinable_shapes()) {
    const SurfaceCurve& curve = shape->curve();
    for (const int levels : {1, 2}) {
      const SurfaceCurve raised = subdivide_all(*shape->base, curve, levels);
      ASSERT_EQ(raised.size(), curve.size() << 2 * levels);
      EXPECT_EQ(raised.revision, curve.revision + 1);
      EXPECT_EQ(raised.max_points, curve.max_points << 2 * levels);
      expect_valid_curve(raised);
      for (std::size_t l = 0; l < raised.size(); ++l) {
        const std::size_t parent = l >> 2 * levels;
        ASSERT_EQ(raised.level[l], curve.level[parent] + levels);
        ASSERT_EQ(raised.area[l], curve.area[parent] / static_cast<float>(1 << 2 * levels));
      }
    }
  }
}

TEST(SubdivideAll, PlacesVerticesAsAFirstBuildDoes) {
  for (const auto& shape : refinable_shapes()) {
    const SurfaceCurve& curve = shape->curve();
    const SurfaceCurve raised = subdivide_all(*shape->base, curve, 1);
    const absl::StatusOr<Preprocessed> fresh = lay_curve(shape->done.flattened, {.points = 4 * curve.max_points});
    ASSERT_TRUE(fresh.ok());
    std::size_t same = 0;
    const std::size_t common = for_each_common(raised, *fresh->curve, [&](std::size_t l, std::size_t m) {
      if (same_vertex(raised, l, *fresh->curve, m)) {
        ++same;
      } else {
        // The centre lies on an edge, or two triangles claim it: the other one, then, at the same place.
        EXPECT_LT((raised.position(l) - fresh->curve->position(m)).norm(), 1e-5 * curve.box.diagonal());
      }
    });
    // The same demand, four times as high, makes the same leaves one level deeper, but for children that lie away from the
    // triangle for which their parent was divided.
    EXPECT_GT(static_cast<double>(common), 0.95 * static_cast<double>(fresh->curve->size()));
    EXPECT_GE(static_cast<double>(same), 0.9 * static_cast<double>(common));
  }
}

TEST(SubdivideAll, IsTheSameForAnyNumberOfThreads) {
  const auto shape = refinable(torus(60, 30), 3000);
  tbb::task_arena one(1), four(4);
  const SurfaceCurve a = one.execute([&] { return subdivide_all(*shape->base, shape->curve(), 1); });
  const SurfaceCurve b = four.execute([&] { return subdivide_all(*shape->base, shape->curve(), 1); });
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t l = 0; l < a.size(); ++l) {
    ASSERT_TRUE(same_vertex(a, l, b, l));
    ASSERT_EQ(a.area[l], b.area[l]);
  }
}

TEST(SubdivideAll, LeavesAtTheEndOfTheKeysStay) {
  // A curve of one leaf per disc but for a corner that goes all the way down.
  const auto shape = refinable(single_triangle(), 1);
  SurfaceCurve curve = next_revision(shape->curve());
  const int deep = kMaxLevel;
  std::vector<std::pair<std::uint64_t, int>> leaves = {{0, deep}};
  for (int level = deep; level > 0; --level) {
    const std::uint64_t step = std::uint64_t{1} << 2 * (kMaxLevel - level);
    for (std::uint64_t i = 1; i < 4; ++i) leaves.emplace_back(i * step, level);
  }
  curve.resize(leaves.size());
  curve.disc_begin = {0, static_cast<std::uint32_t>(leaves.size())};
  for (std::size_t l = 0; l < leaves.size(); ++l) {
    curve.key[l] = leaves[l].first;
    curve.level[l] = static_cast<std::uint8_t>(leaves[l].second);
    curve.area[l] = 1;
    curve.triangle[l] = 0;
  }
  const SurfaceCurve raised = subdivide_all(*shape->base, curve, 2);
  // Four at the last level stay, three above it are divided once, the others twice.
  EXPECT_EQ(raised.size(), 4 + 3 * 4 + (leaves.size() - 7) * 16);
  EXPECT_EQ(raised.max_points, curve.max_points);
  std::uint64_t expected = 0;
  for (std::size_t l = 0; l < raised.size(); ++l) {
    ASSERT_EQ(raised.key[l], expected);
    ASSERT_LE(raised.level[l], kMaxLevel);
    expected += std::uint64_t{1} << 2 * (kMaxLevel - raised.level[l]);
  }
}

}  // namespace
}  // namespace curvecast
