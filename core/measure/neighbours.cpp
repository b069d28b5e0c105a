#include "core/measure/neighbours.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/float4.h"
#include "core/measure/nearest_lists.h"

namespace curvecast {
namespace {

using Leaf = PointTree::Leaf;
using Boxes = PointTree::Boxes;
constexpr std::size_t kLeafSize = PointTree::kLeafSize;
constexpr std::size_t kFanOut = PointTree::kFanOut;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Calls visit(i) for every bit i that is set.
template <typename Visit>
void for_each_bit(unsigned bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(static_cast<unsigned>(std::countr_zero(bits)));
}

}  // namespace

/// The walks over the tree. Distances to boxes are rounded like those to points, step by step, so a box is never farther than a
/// point in it.
class NeighbourSearch {
 public:
  explicit NeighbourSearch(const PointTree& tree) : tree_(tree) {}

  template <typename List>
  void nearest(const Vec3f& query, List& list) {
    walk(
        query, query, [&] { return list.limit(); }, [&](std::uint32_t leaf) { scan(tree_.leaves[leaf], query, list); });
  }

  void within(const Vec3f& query, float limit, std::vector<Neighbour>& found) {
    alignas(16) float square[kLeafSize];
    walk(
        query, query, [&] { return limit; },
        [&](std::uint32_t leaf) {
          const Leaf& points = tree_.leaves[leaf];
          for_each_bit(near_points(points, query, limit, square), [&](unsigned i) {
            found.push_back({points.index[i], square[i]});
          });
        });
  }

  /// The k nearest of every point of a leaf, all in one walk.
  void nearest_of_leaf(std::uint32_t leaf, std::size_t k, std::span<Neighbour> found) {
    const Leaf& queries = tree_.leaves[leaf];
    const std::size_t count = count_of(queries);
    Vec3f min = Vec3f::Constant(kInfinity), max = -min;
    limits_.fill(-1);  // wants nothing
    for (std::size_t q = 0; q < count; ++q) {
      const std::span<Neighbour> wanted = found.subspan(queries.index[q] * k, k);
      std::fill(wanted.begin(), wanted.end(), Neighbour{});
      lists_[q] = NearestMany(wanted);
      const Vec3f query = query_at(queries, q);
      if (!query.allFinite()) continue;
      limits_[q] = kFarthest;
      min = min.cwiseMin(query);
      max = max.cwiseMax(query);
    }
    offer_own(leaf);
    float limit = largest_limit();
    walk(
        min, max, [&] { return limit; },
        [&](std::uint32_t other) {
          if (other != leaf && offer(leaf, other)) limit = largest_limit();
        });
  }

 private:
  static constexpr std::size_t kLevels = 10;  // of boxes over the 2^28 leaves of 2^32 points

  /// A node whose children are being visited.
  struct Opened {
    alignas(16) float square[kFanOut];  // of the children's distances
    std::uint32_t node;                 // its index in its level
    unsigned pending;                   // bit c: child c is still to be visited
  };

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

  /// Writes squared distances to eight boxes; returns the least, in all four places.
  static Float4 measure(const Boxes& boxes, const Reach& reach, float* square) {
    Float4 squares[2];
    for (unsigned half = 0; half < 2; ++half) {
      const unsigned c = 4 * half;
      Float4 gap[3];
      for (int axis = 0; axis < 3; ++axis) {
        gap[axis] =
            max(max(Float4::load(boxes.min[axis] + c) - reach.max[axis], reach.min[axis] - Float4::load(boxes.max[axis] + c)),
                Float4::all(0));
      }
      squares[half] = squared_norm(gap[0], gap[1], gap[2]);
      squares[half].store(square + c);
    }
    return least(min(squares[0], squares[1]));
  }

  /// Bit c: the squared distance of child c is within the limit.
  static unsigned near_children(const float* square, Float4 limit) {
    return less_or_equal(Float4::load(square), limit) | less_or_equal(Float4::load(square + 4), limit) << 4;
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

  template <typename List>
  static void scan(const Leaf& leaf, const Vec3f& query, List& list) {
    alignas(16) float square[kLeafSize];
    for_each_bit(near_points(leaf, query, list.limit(), square), [&](unsigned i) { list.offer({leaf.index[i], square[i]}); });
  }

  static std::size_t count_of(const Leaf& leaf) {
    return static_cast<std::size_t>(std::find(leaf.index, leaf.index + kLeafSize, Neighbour::kNobody) - leaf.index);
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
    const Leaf& points = tree_.leaves[leaf];
    alignas(16) float square[kLeafSize];
    for (unsigned q = 0; q < count_of(points); ++q) {
      const unsigned near = near_points(points, query_at(points, q), limits_[q], square) & ~(1u << q);
      for_each_bit(near, [&](unsigned i) { lists_[q].offer({points.index[i], square[i]}); });
      limits_[q] = std::min(limits_[q], lists_[q].limit());
    }
  }

  /// Offers another leaf's points to all of this one's. Returns whether any wanted them.
  bool offer(std::uint32_t leaf, std::uint32_t other) {
    const Leaf& queries = tree_.leaves[leaf];
    const Leaf& points = tree_.leaves[other];
    const Boxes& boxes = tree_.boxes[other / kFanOut];
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
      scan(points, query_at(queries, q), lists_[q]);
      limits_[q] = lists_[q].limit();
    });
    return wanted != 0;
  }

  /// Calls visit(leaf) for the leaves that lie within limit() of the box. It may fall meanwhile: the nearest child comes first,
  /// all the way down, so that it falls quickly, and then whatever else still lies within it.
  template <typename Limit, typename Visit>
  void walk(const Vec3f& min, const Vec3f& max, Limit&& limit, Visit&& visit) {
    const Reach reach(min, max);
    std::array<Opened, kLevels> path;
    const std::size_t root = tree_.level_begin.size() - 2;
    std::size_t level = root;
    for (std::uint32_t node = 0;;) {
      Opened& opened = path[level];
      const Float4 nearest = measure(tree_.boxes[tree_.level_begin[level] + node], reach, opened.square);
      const unsigned wanted = near_children(opened.square, Float4::all(limit()));
      if (wanted != 0) {
        const auto first = static_cast<unsigned>(std::countr_zero(near_children(opened.square, nearest)));
        opened.node = node;
        opened.pending = wanted & ~(1u << first);
        const std::uint32_t children = node * kFanOut;
        if (level > 0) {
          node = children + first;
          --level;
          continue;
        }
        visit(children + first);
        opened.pending &= near_children(opened.square, Float4::all(limit()));
        for_each_bit(opened.pending, [&](unsigned c) { visit(children + c); });
      }
      // Up to where something is left to visit.
      do {
        if (++level > root) return;
        path[level].pending &= near_children(path[level].square, Float4::all(limit()));
      } while (path[level].pending == 0);
      node = path[level].node * kFanOut + static_cast<unsigned>(std::countr_zero(path[level].pending));
      path[level].pending &= path[level].pending - 1;
      --level;
    }
  }

  const PointTree& tree_;
  // Of the points of the leaf for which nearest_of_leaf() searches.
  std::array<NearestMany, kLeafSize> lists_;
  alignas(16) std::array<float, kLeafSize> limits_;
};

std::size_t NeighbourTree::nearest(const Vec3f& query, std::span<Neighbour> found) const {
  const std::size_t k = found.size();
  std::fill(found.begin(), found.end(), Neighbour{});
  if (k == 0 || size() == 0 || !query.allFinite()) return 0;
  const auto search = [&](auto list) {
    NeighbourSearch(tree_).nearest(query, list);
    list.write(found);
  };
  if (k == 1) {
    search(NearestOne());
  } else if (k <= 8) {
    search(NearestFew<8>(k));
  } else if (k <= 16) {
    search(NearestFew<16>(k));
  } else {
    search(NearestMany(found));
  }
  const auto nobody = [](const Neighbour& n) { return n.index == Neighbour::kNobody; };
  return static_cast<std::size_t>(std::find_if(found.begin(), found.end(), nobody) - found.begin());
}

void NeighbourTree::within(const Vec3f& query, float radius, std::vector<Neighbour>& found) const {
  found.clear();
  if (size() == 0 || !query.allFinite() || !(radius >= 0)) return;
  NeighbourSearch(tree_).within(query, std::min(radius * radius, kFarthest), found);
}

void NeighbourTree::all_nearest(std::size_t k, std::span<Neighbour> found) const {
  if (k == 0) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree_.leaves.size(), 64), [&](const auto& range) {
    NeighbourSearch search(tree_);
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      search.nearest_of_leaf(static_cast<std::uint32_t>(leaf), k, found);
    }
  });
}

}  // namespace curvecast
