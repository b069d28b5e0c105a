#include "core/measure/point_tree.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <limits>
#include <vector>

#include "core/base/random.h"
#include "core/base/vec.h"

namespace curvecast {
namespace {

std::vector<Vec3f> noise(std::size_t n) {
  std::vector<Vec3f> points;
  const auto unit = [](std::size_t i) { return static_cast<float>(random_unit(9, i)); };
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2));
  return points;
}

std::size_t leaf_size(const PointTree::Leaf& leaf) {
  std::size_t size = 0;
  while (size < PointTree::kLeafSize && leaf.index[size] != PointTree::kNobody) ++size;
  return size;
}

bool holds(const PointTree::Boxes& boxes, std::size_t c, const Vec3f& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (boxes.min[axis][c] > p[axis] || boxes.max[axis][c] < p[axis]) return false;
  }
  return true;
}

TEST(PointTree, HasEveryPointOnceInAnEvenlyFilledLeaf) {
  for (const std::size_t n : {1, 16, 17, 129, 5000}) {
    const std::vector<Vec3f> points = noise(n);
    const PointTree tree(view_of(points));
    std::vector<int> seen(n);
    for (const PointTree::Leaf& leaf : tree.leaves) {
      const std::size_t size = leaf_size(leaf);
      EXPECT_GE(size, n / tree.leaves.size());
      for (std::size_t i = 0; i < size; ++i) {
        ASSERT_LT(leaf.index[i], n);
        ++seen[leaf.index[i]];
        EXPECT_EQ(Vec3f(leaf.p[0][i], leaf.p[1][i], leaf.p[2][i]), points[leaf.index[i]]);
      }
    }
    EXPECT_EQ(seen, std::vector<int>(n, 1));
  }
}

TEST(PointTree, BoxesHoldWhatIsUnderThem) {
  const std::vector<Vec3f> points = noise(5000);
  const PointTree tree(view_of(points));
  for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
    for (std::size_t i = 0; i < leaf_size(tree.leaves[leaf]); ++i) {
      const Vec3f& p = points[tree.leaves[leaf].index[i]];
      std::size_t child = leaf;
      for (std::size_t level = 0; level + 1 < tree.level_begin.size(); ++level, child /= PointTree::kFanOut) {
        const PointTree::Boxes& boxes = tree.boxes[tree.level_begin[level] + child / PointTree::kFanOut];
        ASSERT_TRUE(holds(boxes, child % PointTree::kFanOut, p)) << "level " << level;
      }
    }
  }
}

TEST(PointTree, LeavesOfEvenPointsHardlyOverlap) {
  // Halving without end makes boxes that fill space once; their volumes would add up to far more if they overlapped.
  const std::vector<Vec3f> points = noise(1 << 14);
  const PointTree tree(view_of(points));
  double volume = 0;
  for (std::size_t leaf = 0; leaf < tree.leaves.size(); ++leaf) {
    const PointTree::Boxes& boxes = tree.boxes[leaf / PointTree::kFanOut];
    const std::size_t c = leaf % PointTree::kFanOut;
    double product = 1;
    for (int axis = 0; axis < 3; ++axis) product *= boxes.max[axis][c] - boxes.min[axis][c];
    volume += product;
  }
  EXPECT_LT(volume, 1);
}

TEST(PointTree, BoxesPassOverWhatIsNotFinite) {
  std::vector<Vec3f> points = noise(100);
  points[3].x() = std::numeric_limits<float>::quiet_NaN();
  points[50].z() = -std::numeric_limits<float>::infinity();
  const PointTree tree(view_of(points));
  const PointTree::Boxes& root = tree.boxes.back();
  for (std::size_t c = 0; c < tree.leaves.size(); ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(root.min[axis][c], 0);
      EXPECT_LE(root.max[axis][c], 1);
    }
  }
}

TEST(PointTree, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3f> points = noise(100'000);
  PointTree trees[2];
  tbb::task_arena(1).execute([&] { trees[0] = PointTree(view_of(points)); });
  tbb::task_arena(4).execute([&] { trees[1] = PointTree(view_of(points)); });
  ASSERT_EQ(trees[0].byte_size(), trees[1].byte_size());
  EXPECT_EQ(std::memcmp(trees[0].leaves.data(), trees[1].leaves.data(), trees[0].leaves.size() * sizeof(PointTree::Leaf)), 0);
  EXPECT_EQ(std::memcmp(trees[0].boxes.data(), trees[1].boxes.data(), trees[0].boxes.size() * sizeof(PointTree::Boxes)), 0);
}

}  // namespace
}  // namespace curvecast
