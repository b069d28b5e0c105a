#include "core/curve/neighbours.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/float4.h"

namespace curvecast {
namespace {

constexpr float kFarthest = std::numeric_limits<float>::max();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Larger for what is farther, or as far with a larger index.
std::uint64_t order_of(const Neighbour& n) {
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(n.square)) << 32 | n.index;
}

float larger(float a, float b) { return a > b ? a : b; }
float smaller(float a, float b) { return a < b ? a : b; }

/// Calls visit(i) for every bit i that is set.
template <typename Visit>
void for_each_bit(unsigned bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<unsigned>(std::countr_zero(bits)));
}

/// A list of the nearest found so far, in order; its last entry falls out when a nearer one comes.
struct Nearest {
  Neighbour* found;
  std::size_t k;
  float limit;  // nothing farther is wanted

  void clear() {
    std::fill_n(found, k, Neighbour{});
    limit = kFarthest;
  }
  void offer(const Neighbour& n) {
    const std::uint64_t order = order_of(n);
    if (order >= order_of(found[k - 1])) return;
    std::size_t i = k - 1;
    for (; i > 0 && order_of(found[i - 1]) > order; --i) found[i] = found[i - 1];
    found[i] = n;
    limit = smaller(found[k - 1].square, kFarthest);
  }
};

}  // namespace

NeighbourTree::NeighbourTree(const PointView& points, std::span<const std::uint32_t> piece_begin) : size_(points.size) {
  if (size_ == 0) return;
  fill_leaves(points, piece_begin);
  stack_boxes();
}

void NeighbourTree::fill_leaves(const PointView& points, std::span<const std::uint32_t> piece_begin) {
  std::vector<PointPiece> pieces;
  if (piece_begin.empty()) pieces.push_back({0, static_cast<std::uint32_t>(size_)});
  for (std::size_t i = 1; i < piece_begin.size(); ++i) {
    const std::uint32_t begin = piece_begin[i - 1];
    if (piece_begin[i] > begin) pieces.push_back({begin, piece_begin[i] - begin});
  }
  if (pieces.size() > kFanOut) order_in_space(points, pieces);
  std::size_t leaf_count = 0;
  for (PointPiece& piece : pieces) {
    piece.first_leaf = leaf_count;
    leaf_count += (piece.size + kLeafSize - 1) / kLeafSize;
  }
  leaves_.resize(leaf_count);
  first_.resize(leaf_count);
  count_.resize(leaf_count);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaf_count, 256), [&](const auto& range) {
    auto piece = std::upper_bound(pieces.begin(), pieces.end(), range.begin(),
                                  [](std::size_t leaf, const PointPiece& p) { return leaf < p.first_leaf; }) -
                 1;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (piece + 1 != pieces.end() && (piece + 1)->first_leaf == i) ++piece;
      // Leaves of a piece are filled evenly.
      const std::size_t parts = (piece->size + kLeafSize - 1) / kLeafSize;
      const std::size_t part = i - piece->first_leaf;
      const std::size_t begin = piece->begin + part * piece->size / parts;
      const std::size_t end = piece->begin + (part + 1) * piece->size / parts;
      first_[i] = static_cast<std::uint32_t>(begin);
      count_[i] = static_cast<std::uint8_t>(end - begin);
      const float* const axes[3] = {points.x, points.y, points.z};
      for (int axis = 0; axis < 3; ++axis) {
        float* to = leaves_[i].p[axis];
        for (std::size_t p = begin; p < end; ++p) *to++ = axes[axis][p * points.stride];
        std::fill(to, leaves_[i].p[axis] + kLeafSize, kInfinity);
      }
    }
  });
}

void NeighbourTree::stack_boxes() {
  level_begin_.assign(1, 0);
  for (std::size_t children = leaves_.size();;) {
    const std::size_t groups = (children + kFanOut - 1) / kFanOut;
    level_begin_.push_back(level_begin_.back() + static_cast<std::uint32_t>(groups));
    if (groups == 1) break;
    children = groups;
  }
  boxes_.resize(level_begin_.back());
  for (std::size_t level = 0; level + 1 < level_begin_.size(); ++level) {
    const std::size_t begin = level_begin_[level];
    const std::size_t groups = level_begin_[level + 1] - begin;
    const std::size_t below = level == 0 ? 0 : level_begin_[level - 1];
    const std::size_t children = level == 0 ? leaves_.size() : begin - below;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 64), [&](const auto& range) {
      for (std::size_t g = range.begin(); g < range.end(); ++g) {
        Boxes& boxes = boxes_[begin + g];
        for (std::size_t c = 0; c < kFanOut; ++c) {
          const std::size_t child = g * kFanOut + c;
          for (int axis = 0; axis < 3; ++axis) {
            float min = kInfinity, max = -kInfinity;
            if (child < children && level == 0) {
              for (std::size_t i = 0; i < count_[child]; ++i) {
                const float p = leaves_[child].p[axis][i];
                min = smaller(p, min);
                max = larger(p, max);
              }
            } else if (child < children) {
              for (std::size_t i = 0; i < kFanOut; ++i) {
                min = smaller(boxes_[below + child].min[axis][i], min);
                max = larger(boxes_[below + child].max[axis][i], max);
              }
            }
            boxes.min[axis][c] = min;
            boxes.max[axis][c] = max;
          }
        }
      }
    });
  }
}

std::size_t NeighbourTree::byte_size() const {
  return leaves_.size() * (sizeof(Leaf) + sizeof(first_[0]) + sizeof(count_[0])) + boxes_.size() * sizeof(Boxes);
}

/// The walks over the tree. Distances to boxes are rounded like those to points, step by step, so a box is never farther than a
/// point in it.
class NeighbourSearch {
 public:
  explicit NeighbourSearch(const NeighbourTree& tree) : tree_(tree) {}

  void nearest(const Vec3f& query, Nearest& list) {
    // The nearest boxes first: boxes of runs of a curve overlap, so the first leaf seldom has it all, but the limit falls
    // quickly.
    const Reach reach(query, query);
    std::array<Candidate, kStack> stack;
    std::size_t top = 0;
    stack[top++] = {0, root()};
    alignas(16) float square[kFanOut];
    while (top > 0) {
      const Candidate next = stack[--top];
      if (next.square > list.limit) continue;
      if (level_of(next.node) == 0) {
        const std::uint32_t leaf = index_of(next.node);
        scan(tree_.leaves_[leaf], tree_.first_[leaf], query, list);
        continue;
      }
      const std::size_t begin = top;
      for_each_bit(near_boxes(boxes_of(next.node), reach, list.limit, square), [&](unsigned c) {
        std::size_t at = top++;
        for (; at > begin && stack[at - 1].square < square[c]; --at) stack[at] = stack[at - 1];
        stack[at] = {square[c], child_of(next.node, c)};
      });
    }
  }

  void within(const Vec3f& query, float limit, std::vector<Neighbour>& found) {
    alignas(16) float square[kLeafSize];
    walk(
        query, query, [&] { return limit; },
        [&](std::uint32_t leaf) {
          const std::uint32_t first = tree_.first_[leaf];
          for_each_bit(near_points(tree_.leaves_[leaf], query, limit, square), [&](unsigned i) {
            found.push_back({first + i, square[i]});
          });
        });
  }

  /// The k nearest of every point of a leaf, all in one walk.
  void nearest_of_leaf(std::uint32_t leaf, std::size_t k, std::span<Neighbour> found) {
    const Leaf& queries = tree_.leaves_[leaf];
    const std::size_t count = tree_.count_[leaf];
    Vec3f min = Vec3f::Constant(kInfinity), max = -min;
    std::fill(limits_.begin(), limits_.end(), -1.0f);  // wants nothing
    for (std::size_t q = 0; q < count; ++q) {
      lists_[q] = {&found[(tree_.first_[leaf] + q) * k], k, kFarthest};
      lists_[q].clear();
      const Vec3f query = query_at(queries, q);
      if (!query.allFinite()) continue;
      limits_[q] = kFarthest;
      min = min.cwiseMin(query);
      max = max.cwiseMax(query);
    }
    // The leaves beside this one on the curve bring the limits down at once.
    std::uint32_t begin = leaf, end = leaf + 1;
    std::size_t seen = count;
    offer_own(leaf);
    const auto leaf_count = static_cast<std::uint32_t>(tree_.leaves_.size());
    for (bool first = true; (first || seen <= k) && (begin > 0 || end < leaf_count); first = false) {
      if (begin > 0) {
        offer(leaf, --begin);
        seen += tree_.count_[begin];
      }
      if (end < leaf_count) {
        offer(leaf, end);
        seen += tree_.count_[end++];
      }
    }
    float limit = largest_limit();
    walk(
        min, max, [&] { return limit; },
        [&](std::uint32_t other) {
          if (other >= begin && other < end) return;
          if (offer(leaf, other)) limit = largest_limit();
        });
  }

 private:
  using Leaf = NeighbourTree::Leaf;
  using Boxes = NeighbourTree::Boxes;
  static constexpr std::size_t kLeafSize = NeighbourTree::kLeafSize;
  static constexpr std::size_t kFanOut = NeighbourTree::kFanOut;
  // A node is its level (0: leaves) and its index there; 2^32 points have 2^28 leaves and ten levels of boxes over them.
  static constexpr int kIndexBits = 28;
  static constexpr std::size_t kStack = 11 * kFanOut;

  struct Candidate {
    float square;  // of its box's distance
    std::uint32_t node;
  };

  static std::uint32_t level_of(std::uint32_t node) { return node >> kIndexBits; }
  static std::uint32_t index_of(std::uint32_t node) { return node & ((1u << kIndexBits) - 1); }
  static std::uint32_t child_of(std::uint32_t node, unsigned c) {
    return (level_of(node) - 1) << kIndexBits | (index_of(node) * kFanOut + c);
  }
  std::uint32_t root() const { return static_cast<std::uint32_t>(tree_.level_begin_.size() - 1) << kIndexBits; }
  const Boxes& boxes_of(std::uint32_t node) const {
    return tree_.boxes_[tree_.level_begin_[level_of(node) - 1] + index_of(node)];
  }

  /// A box, or a point where min = max, ready to be compared with four at once.
  struct Reach {
    Float4 min[3], max[3];

    Reach(const Vec3f& lower, const Vec3f& upper) {
      for (int axis = 0; axis < 3; ++axis) {
        min[axis] = Float4::all(lower[axis]);
        max[axis] = Float4::all(upper[axis]);
      }
    }
  };

  static Float4 squared_norm(Float4 x, Float4 y, Float4 z) { return x * x + y * y + z * z; }

  /// Squared distances to eight boxes; bit c: that of box c is within the limit.
  static unsigned near_boxes(const Boxes& boxes, const Reach& reach, float limit, float* square) {
    unsigned bits = 0;
    for (unsigned c = 0; c < kFanOut; c += 4) {
      Float4 gap[3];
      for (int axis = 0; axis < 3; ++axis) {
        gap[axis] =
            max(max(Float4::load(boxes.min[axis] + c) - reach.max[axis], reach.min[axis] - Float4::load(boxes.max[axis] + c)),
                Float4::all(0));
      }
      const Float4 squares = squared_norm(gap[0], gap[1], gap[2]);
      squares.store(square + c);
      bits |= less_or_equal(squares, Float4::all(limit)) << c;
    }
    return bits;
  }

  /// Squared distances to a leaf's points; bit i: that of point i is within the limit.
  static unsigned near_points(const Leaf& leaf, const Vec3f& query, float limit, float* square) {
    unsigned bits = 0;
    for (unsigned i = 0; i < kLeafSize; i += 4) {
      const Float4 squares =
          squared_norm(Float4::load(leaf.p[0] + i) - Float4::all(query[0]), Float4::load(leaf.p[1] + i) - Float4::all(query[1]),
                       Float4::load(leaf.p[2] + i) - Float4::all(query[2]));
      squares.store(square + i);
      bits |= less_or_equal(squares, Float4::all(limit)) << i;
    }
    return bits;
  }

  static void scan(const Leaf& leaf, std::uint32_t first, const Vec3f& query, Nearest& list) {
    alignas(16) float square[kLeafSize];
    for_each_bit(near_points(leaf, query, list.limit, square), [&](unsigned i) { list.offer({first + i, square[i]}); });
  }

  static Vec3f query_at(const Leaf& leaf, std::size_t q) { return {leaf.p[0][q], leaf.p[1][q], leaf.p[2][q]}; }

  float largest_limit() const {
    Float4 largest = Float4::load(limits_.data());
    for (std::size_t q = 4; q < kLeafSize; q += 4) largest = max(largest, Float4::load(&limits_[q]));
    alignas(16) float parts[4];
    largest.store(parts);
    return std::max(std::max(parts[0], parts[1]), std::max(parts[2], parts[3]));
  }

  /// Offers a leaf's points to one another.
  void offer_own(std::uint32_t leaf) {
    const Leaf& points = tree_.leaves_[leaf];
    alignas(16) float square[kLeafSize];
    for (unsigned q = 0; q < tree_.count_[leaf]; ++q) {
      const unsigned near = near_points(points, query_at(points, q), limits_[q], square) & ~(1u << q);
      for_each_bit(near, [&](unsigned i) { lists_[q].offer({tree_.first_[leaf] + i, square[i]}); });
      limits_[q] = std::min(limits_[q], lists_[q].limit);
    }
  }

  /// Offers another leaf's points to all of this one's. Returns whether any wanted them.
  bool offer(std::uint32_t leaf, std::uint32_t other) {
    const Leaf& queries = tree_.leaves_[leaf];
    const Leaf& points = tree_.leaves_[other];
    const Boxes& boxes = tree_.boxes_[other / kFanOut];
    const std::size_t c = other % kFanOut;
    unsigned wanted = 0;
    for (unsigned q = 0; q < kLeafSize; q += 4) {
      Float4 gap[3];
      for (int axis = 0; axis < 3; ++axis) {
        const Float4 p = Float4::load(queries.p[axis] + q);
        gap[axis] = max(max(Float4::all(boxes.min[axis][c]) - p, p - Float4::all(boxes.max[axis][c])), Float4::all(0));
      }
      wanted |= less_or_equal(squared_norm(gap[0], gap[1], gap[2]), Float4::load(&limits_[q])) << q;
    }
    for_each_bit(wanted, [&](unsigned q) {
      scan(points, tree_.first_[other], query_at(queries, q), lists_[q]);
      limits_[q] = lists_[q].limit;
    });
    return wanted != 0;
  }

  /// Calls visit(leaf) for the leaves that lie within limit() of the box.
  template <typename Limit, typename Visit>
  void walk(const Vec3f& min, const Vec3f& max, Limit&& limit, Visit&& visit) {
    std::array<std::uint32_t, kStack> stack;
    std::size_t top = 0;
    stack[top++] = root();
    const Reach reach(min, max);
    alignas(16) float square[kFanOut];
    while (top > 0) {
      const std::uint32_t node = stack[--top];
      for_each_bit(near_boxes(boxes_of(node), reach, limit(), square), [&](unsigned c) {
        const std::uint32_t child = child_of(node, c);
        if (level_of(child) == 0) {
          visit(index_of(child));
        } else {
          stack[top++] = child;
        }
      });
    }
  }

  const NeighbourTree& tree_;
  // Of the points of the leaf for which nearest_of_leaf() searches.
  std::array<Nearest, kLeafSize> lists_;
  alignas(16) std::array<float, kLeafSize> limits_;
};

std::size_t NeighbourTree::nearest(const Vec3f& query, std::span<Neighbour> found) const {
  if (found.empty()) return 0;
  Nearest list{found.data(), found.size(), kFarthest};
  list.clear();
  if (size_ == 0 || !query.allFinite()) return 0;
  NeighbourSearch(*this).nearest(query, list);
  const auto nobody = [](const Neighbour& n) { return n.index == Neighbour::kNobody; };
  return static_cast<std::size_t>(std::find_if(found.begin(), found.end(), nobody) - found.begin());
}

void NeighbourTree::within(const Vec3f& query, float radius, std::vector<Neighbour>& found) const {
  found.clear();
  if (size_ == 0 || !query.allFinite() || !(radius >= 0)) return;
  NeighbourSearch(*this).within(query, smaller(radius * radius, kFarthest), found);
}

void NeighbourTree::all_nearest(std::size_t k, std::span<Neighbour> found) const {
  if (k == 0) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves_.size(), 64), [&](const auto& range) {
    NeighbourSearch search(*this);
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      search.nearest_of_leaf(static_cast<std::uint32_t>(leaf), k, found);
    }
  });
}

}  // namespace curvecast
