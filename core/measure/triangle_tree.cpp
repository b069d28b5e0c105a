#include "core/measure/triangle_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

#include "core/base/simd.h"
#include "core/measure/kd_order.h"
#include "core/mesh/triangle_distance.h"

namespace curvecast {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : corners_(mesh.face_count()) {
  std::vector<Vec3d> middles(mesh.face_count());
  const auto corners_of = [&](std::size_t f) {
    const Triangle& t = mesh.triangles[f];
    return Corners{mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
  };
  for (std::size_t f = 0; f < middles.size(); ++f) {
    const auto [a, b, c] = corners_of(f);
    middles[f] = (a + b + c) / 3;
  }
  faces_ = kd_order(middles, kLeafSize);
  for (std::size_t i = 0; i < faces_.size(); ++i) corners_[i] = corners_of(faces_[i]);
  stack_boxes();
}

void TriangleTree::stack_boxes() {
  const Runs leaves(corners_.size(), kLeafSize);
  level_begin_.assign(1, 0);
  for (std::size_t children = leaves.count; level_begin_.size() == 1 || children > 1;) {
    children = (children + kFanOut - 1) / kFanOut;
    level_begin_.push_back(level_begin_.back() + static_cast<std::uint32_t>(children));
  }
  Boxes nothing;
  for (int axis = 0; axis < 3; ++axis) {
    std::fill_n(nothing.min[axis], kFanOut, kInfinity);
    std::fill_n(nothing.max[axis], kFanOut, -kInfinity);
  }
  boxes_.assign(level_begin_.back(), nothing);
  for (std::size_t leaf = 0; leaf < leaves.count; ++leaf) {
    Box3d box;
    for (std::size_t i = leaves.begin(leaf); i < leaves.end(leaf); ++i) {
      for (const Vec3d& p : corners_[i]) box.extend(p);
    }
    std::size_t child = leaf;
    for (std::size_t level = 0; level + 1 < level_begin_.size(); ++level, child /= kFanOut) {
      Boxes& boxes = boxes_[level_begin_[level] + child / kFanOut];
      for (int axis = 0; axis < 3; ++axis) {
        double &min = boxes.min[axis][child % kFanOut], &max = boxes.max[axis][child % kFanOut];
        min = fast_min(box.min[axis], min);
        max = fast_max(box.max[axis], max);
      }
    }
  }
}

TriangleTree::Found TriangleTree::search(const Vec3d& point, std::size_t guess) const {
  struct Candidate {
    double square;  // of its box's distance
    std::size_t level, index;
  };
  const auto distance_to = [&](std::size_t place) {
    const auto& [a, b, c] = corners_[place];
    return triangle_distance(point, a, b, c);
  };
  const Runs leaves(corners_.size(), kLeafSize);
  Found best{guess, distance_to(guess)};
  // 2^32 faces have ten levels of boxes over their leaves. The nearest boxes are searched first.
  std::array<Candidate, 11 * kFanOut> stack;
  std::size_t top = 0;
  stack[top++] = {0, level_begin_.size() - 1, 0};
  while (top > 0) {
    const Candidate next = stack[--top];
    if (next.square > best.distance * best.distance) continue;
    if (next.level == 0) {
      for (std::size_t i = leaves.begin(next.index); i < leaves.end(next.index); ++i) {
        const double distance = distance_to(i);
        if (distance < best.distance) best = {i, distance};
      }
      continue;
    }
    const Boxes& boxes = boxes_[level_begin_[next.level - 1] + next.index];
    double square[kFanOut];
    for (std::size_t c = 0; c < kFanOut; ++c) {
      square[c] = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double gap = fast_max(fast_max(boxes.min[axis][c] - point[axis], point[axis] - boxes.max[axis][c]), 0);
        square[c] += gap * gap;
      }
    }
    const std::size_t begin = top;
    for (std::size_t c = 0; c < kFanOut; ++c) {
      if (!(square[c] <= best.distance * best.distance)) continue;
      std::size_t at = top++;
      for (; at > begin && stack[at - 1].square < square[c]; --at) stack[at] = stack[at - 1];
      stack[at] = {square[c], next.level - 1, next.index * kFanOut + c};
    }
  }
  return best;
}

NearestFace TriangleTree::nearest(const Vec3d& point) const {
  const Found found = search(point, 0);
  return {faces_[found.place], found.distance};
}

void TriangleTree::nearest(std::span<const Vec3d> points, std::span<NearestFace> found) const {
  // The triangle of the point before is a good guess. Every block begins without one, so that answers don't depend on threads.
  constexpr std::size_t kBlock = 64;
  tbb::parallel_for(std::size_t{0}, (points.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    std::size_t guess = 0;
    for (std::size_t i = block * kBlock, end = std::min(i + kBlock, points.size()); i < end; ++i) {
      const Found nearest = search(points[i], guess);
      guess = nearest.place;
      found[i] = {faces_[nearest.place], nearest.distance};
    }
  });
}

}  // namespace curvecast
