#include "core/measure/point_tree.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "core/base/float4.h"

namespace curvecast {
namespace {

using Leaf = PointTree::Leaf;
using Boxes = PointTree::Boxes;
constexpr std::size_t kLeafSize = PointTree::kLeafSize;
constexpr std::size_t kFanOut = PointTree::kFanOut;
constexpr std::size_t kSerial = 1 << 14;  // points that one thread halves alone
constexpr float kInfinity = std::numeric_limits<float>::infinity();

float larger(float a, float b) { return a > b ? a : b; }
float smaller(float a, float b) { return a < b ? a : b; }

/// A point on its way to a leaf, of the size of a vector register.
struct alignas(16) Entry {
  float p[3];
  std::uint32_t index;
};

/// Moves entries before the pivot (or as far, if `equal`) to the front; returns how many there are. No jump depends on the data.
template <bool equal>
std::size_t partition(Entry* entries, std::size_t count, int axis, float pivot) {
  std::size_t front = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Entry e = entries[i];
    entries[i] = entries[front];
    entries[front] = e;
    front += equal ? e.p[axis] <= pivot : e.p[axis] < pivot;
  }
  return front;
}

/// An entry's coordinate that about `rank` of `count` lie before.
float guess_pivot(const Entry* entries, std::size_t count, std::size_t rank, int axis) {
  constexpr std::size_t kMost = 63;
  std::array<float, kMost> sample;
  const std::size_t size = count < 64 ? 5 : count < 1024 ? 15 : kMost;
  for (std::size_t i = 0; i < size; ++i) sample[i] = entries[(2 * i + 1) * count / (2 * size)].p[axis];
  float* const wanted = sample.data() + rank * size / count;
  std::nth_element(sample.data(), wanted, sample.data() + size);
  return *wanted;
}

/// Puts the `first` entries that come first along the axis in front of the others.
void halve(std::span<Entry> entries, std::size_t first, int axis) {
  Entry* begin = entries.data();
  std::size_t count = entries.size();
  while (first > 0 && first < count) {
    const float pivot = guess_pivot(begin, count, first, axis);
    std::size_t before = partition<false>(begin, count, axis, pivot);
    if (before == 0) {
      before = partition<true>(begin, count, axis, pivot);
      if (first <= before) return;
    }
    if (first < before) {
      count = before;
    } else {
      begin += before;
      count -= before;
      first -= before;
    }
  }
}

/// Any axis where not all are finite. The fourth lane, the indices, means nothing.
int widest_axis(std::span<const Entry> entries) {
  Float4 least = Float4::load(entries[0].p), most = least;
  for (const Entry& e : entries) {
    const Float4 p = Float4::load(e.p);
    least = min(p, least);
    most = max(p, most);
  }
  alignas(16) float extent[4];
  (most - least).store(extent);
  return static_cast<int>(std::max_element(extent, extent + 3) - extent);
}

void fill(Leaf& leaf, std::span<const Entry> entries) {
  for (std::size_t i = 0; i < kLeafSize; ++i) {
    const bool any = i < entries.size();
    for (int axis = 0; axis < 3; ++axis) leaf.p[axis][i] = any ? entries[i].p[axis] : kInfinity;
    leaf.index[i] = any ? entries[i].index : PointTree::kNobody;
  }
}

/// Fills leaves [begin, end) with the entries that are theirs: all leaves get the same number, give or take one.
void split(std::span<Entry> entries, Column<Leaf>& leaves, std::size_t size, std::size_t begin, std::size_t end) {
  if (begin + 1 == end) return fill(leaves[begin], entries);
  // Where a node of the tree begins, or half of one, or a quarter.
  const int half = std::bit_width(begin ^ (end - 1)) - 1;
  const std::size_t middle = (end - 1) >> half << half;
  const std::size_t first = middle * size / leaves.size() - begin * size / leaves.size();
  halve(entries, first, widest_axis(entries));
  const auto left = [&] { split(entries.first(first), leaves, size, begin, middle); };
  const auto right = [&] { split(entries.subspan(first), leaves, size, middle, end); };
  if (entries.size() > kSerial) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

void fill_leaves(const PointView& points, Column<Leaf>& leaves) {
  Column<Entry> entries;
  entries.resize(points.size);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size, kSerial), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const std::size_t at = i * points.stride;
      Entry& e = entries[i] = {{points.x[at], points.y[at], points.z[at]}, static_cast<std::uint32_t>(i)};
      if (!(std::isfinite(e.p[0]) && std::isfinite(e.p[1]) && std::isfinite(e.p[2]))) std::fill_n(e.p, 3, kInfinity);
    }
  });
  leaves.resize((points.size + kLeafSize - 1) / kLeafSize);
  split({entries.data(), entries.size()}, leaves, points.size, 0, leaves.size());
}

}  // namespace

PointTree::PointTree(const PointView& points) : size(points.size) {
  if (size == 0) return;
  fill_leaves(points, leaves);
  level_begin.assign(1, 0);
  for (std::size_t children = leaves.size();;) {
    const std::size_t groups = (children + kFanOut - 1) / kFanOut;
    level_begin.push_back(level_begin.back() + static_cast<std::uint32_t>(groups));
    if (groups == 1) break;
    children = groups;
  }
  boxes.resize(level_begin.back());
  for (std::size_t level = 0; level + 1 < level_begin.size(); ++level) {
    const std::size_t begin = level_begin[level];
    const std::size_t groups = level_begin[level + 1] - begin;
    const std::size_t below = level == 0 ? 0 : level_begin[level - 1];
    const std::size_t children = level == 0 ? leaves.size() : begin - below;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 64), [&](const auto& range) {
      for (std::size_t g = range.begin(); g < range.end(); ++g) {
        Boxes& into = boxes[begin + g];
        for (std::size_t c = 0; c < kFanOut; ++c) {
          const std::size_t child = g * kFanOut + c;
          for (int axis = 0; axis < 3; ++axis) {
            float min = kInfinity, max = -kInfinity;
            if (child < children && level == 0) {
              for (const float p : leaves[child].p[axis]) {
                min = smaller(p, min);
                max = p < kInfinity ? larger(p, max) : max;
              }
            } else if (child < children) {
              for (std::size_t i = 0; i < kFanOut; ++i) {
                min = smaller(boxes[below + child].min[axis][i], min);
                max = larger(boxes[below + child].max[axis][i], max);
              }
            }
            into.min[axis][c] = min;
            into.max[axis][c] = max;
          }
        }
      }
    });
  }
}

}  // namespace curvecast
