#include "core/curve/adaptive_quadtree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace curvecast {
namespace {

/// A triangle ready for overlap tests with squares: its box and the lines of its sides, positive inside.
struct TriangleTest {
  double min_x, max_x, min_y, max_y;
  std::array<double, 3> a, b, c;  // side i: a x + b y + c

  TriangleTest(const Vec2d& p, const Vec2d& q, const Vec2d& r)
      : min_x(std::min({p.x(), q.x(), r.x()})),
        max_x(std::max({p.x(), q.x(), r.x()})),
        min_y(std::min({p.y(), q.y(), r.y()})),
        max_y(std::max({p.y(), q.y(), r.y()})) {
    const std::array<Vec2d, 3> corner = {p, q, r};
    for (int i = 0; i < 3; ++i) {
      const Vec2d& from = corner[i];
      const Vec2d side = corner[(i + 1) % 3] - from;
      a[i] = -side.y();
      b[i] = side.x();
      c[i] = side.y() * from.x() - side.x() * from.y();
    }
  }

  bool touches(double x, double y, double side) const {
    if (min_x > x + side || max_x < x || min_y > y + side || max_y < y) return false;
    for (int i = 0; i < 3; ++i) {
      // The square's corner that lies farthest on the inner side of the line.
      const double px = a[i] > 0 ? x + side : x;
      const double py = b[i] > 0 ? y + side : y;
      if (a[i] * px + b[i] * py + c[i] < 0) return false;
    }
    return true;
  }
};

struct Node {
  double x, y;
  std::uint64_t index;  // Hilbert index at its level
  int level;
  HilbertState state;
};

Node child_of(const Node& node, unsigned i) {
  const double half = std::ldexp(1.0, -node.level - 1);
  const unsigned quadrant = hilbert_quadrant(node.state, i);
  return {node.x + (quadrant & 1) * half, node.y + (quadrant >> 1) * half, node.index << 2 | i, node.level + 1,
          hilbert_child_state(node.state, i)};
}

class Builder {
 public:
  Builder(const Chart& chart, std::span<const double> demand, std::size_t max_leaves, const ExecutionContext& context)
      : demand_(demand), max_leaves_(max_leaves), context_(context) {
    tests_.reserve(chart.disc.triangles.size());
    for (const Triangle& t : chart.disc.triangles) tests_.emplace_back(chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]);
    cap_ = *std::max_element(demand.begin(), demand.end());
  }

  absl::StatusOr<QuadtreeLeaves> build() {
    for (;;) {
      leaf_count_ = 0;
      QuadtreeLeaves leaves = build_all();
      if (absl::Status status = context_.check(); !status.ok()) return status;
      if (leaf_count_ <= max_leaves_) return leaves;
      cap_ /= 4;
    }
  }

 private:
  // Levels built before the work is shared out; a part is one node of this level.
  static constexpr int kSharedLevel = 4;
  static constexpr std::size_t kSmallChart = 20'000;  // leaves: not worth sharing out

  struct Part {
    Node node;
    std::vector<std::uint32_t> triangles;
    QuadtreeLeaves leaves;
  };

  QuadtreeLeaves build_all() {
    std::vector<std::uint32_t> all(tests_.size());
    for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
    const Node root{0, 0, 0, 0, 0};
    double wanted = 0;
    for (const double d : demand_) wanted = std::max(wanted, std::min(d, cap_));
    QuadtreeLeaves leaves;
    if (wanted < kSmallChart) {
      Scratch scratch;
      grow(root, all, scratch, leaves);
      leaves.triangle_begin.push_back(static_cast<std::uint32_t>(leaves.triangles.size()));
      return leaves;
    }
    std::vector<Part> parts;
    collect_parts(root, std::move(all), parts);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
      Scratch scratch;
      grow(parts[i].node, parts[i].triangles, scratch, parts[i].leaves);
    });
    for (const Part& part : parts) {
      const auto offset = static_cast<std::uint32_t>(leaves.triangles.size());
      leaves.key.insert(leaves.key.end(), part.leaves.key.begin(), part.leaves.key.end());
      leaves.level.insert(leaves.level.end(), part.leaves.level.begin(), part.leaves.level.end());
      for (const std::uint32_t begin : part.leaves.triangle_begin) leaves.triangle_begin.push_back(offset + begin);
      leaves.triangles.insert(leaves.triangles.end(), part.leaves.triangles.begin(), part.leaves.triangles.end());
    }
    leaves.triangle_begin.push_back(static_cast<std::uint32_t>(leaves.triangles.size()));
    return leaves;
  }

  bool is_leaf(const Node& node, std::span<const std::uint32_t> triangles) const {
    if (node.level == kMaxLevel) return true;
    const double limit = std::ldexp(1.0, 2 * node.level);  // vertices per uv area that one vertex in this quad makes
    if (cap_ <= limit) return true;
    return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) { return demand_[t] <= limit; });
  }

  void touching(const Node& node, std::span<const std::uint32_t> from, std::vector<std::uint32_t>& to) const {
    const double side = std::ldexp(1.0, -node.level);
    to.clear();
    for (const std::uint32_t t : from) {
      if (tests_[t].touches(node.x, node.y, side)) to.push_back(t);
    }
  }

  void collect_parts(const Node& node, std::vector<std::uint32_t> triangles, std::vector<Part>& parts) const {
    if (node.level == kSharedLevel || is_leaf(node, triangles)) {
      parts.push_back({node, std::move(triangles), {}});
      return;
    }
    for (unsigned i = 0; i < 4; ++i) {
      const Node child = child_of(node, i);
      std::vector<std::uint32_t> inside;
      touching(child, triangles, inside);
      if (!inside.empty()) collect_parts(child, std::move(inside), parts);
    }
  }

  using Scratch = std::array<std::vector<std::uint32_t>, kMaxLevel + 1>;

  void emit(const Node& node, std::span<const std::uint32_t> triangles, QuadtreeLeaves& leaves) {
    leaves.key.push_back(node.index << 2 * (kMaxLevel - node.level));
    leaves.level.push_back(static_cast<std::uint8_t>(node.level));
    leaves.triangle_begin.push_back(static_cast<std::uint32_t>(leaves.triangles.size()));
    leaves.triangles.insert(leaves.triangles.end(), triangles.begin(), triangles.end());
    constexpr std::size_t kBatch = 4096;
    if (leaves.size() % kBatch == 0) {
      leaf_count_.fetch_add(kBatch, std::memory_order_relaxed);
      if (context_.cancelled()) leaf_count_ = max_leaves_ + 1;
    }
  }

  void grow(const Node& node, std::span<const std::uint32_t> triangles, Scratch& scratch, QuadtreeLeaves& leaves) {
    if (leaf_count_.load(std::memory_order_relaxed) > max_leaves_) return;
    if (is_leaf(node, triangles)) {
      emit(node, triangles, leaves);
      return;
    }
    for (unsigned i = 0; i < 4; ++i) {
      const Node child = child_of(node, i);
      std::vector<std::uint32_t>& inside = scratch[child.level];
      if (triangles.size() == 1) {
        // Nothing else is near: the quad lies in the triangle, and so do its children.
        inside.assign(triangles.begin(), triangles.end());
      } else {
        touching(child, triangles, inside);
      }
      if (!inside.empty()) grow(child, inside, scratch, leaves);
    }
  }

  std::span<const double> demand_;
  std::size_t max_leaves_;
  const ExecutionContext& context_;
  std::vector<TriangleTest> tests_;
  double cap_;  // demands above count as this
  std::atomic<std::size_t> leaf_count_ = 0;
};

}  // namespace

Quad leaf_quad(std::uint64_t key, std::uint8_t level) {
  const HilbertCell cell = hilbert_cell(key >> 2 * (kMaxLevel - level), level);
  const double side = std::ldexp(1.0, -level);
  return {Vec2d(cell.x * side, cell.y * side), side};
}

absl::StatusOr<QuadtreeLeaves> build_quadtree(const Chart& chart, std::span<const double> demand, std::size_t max_leaves,
                                              const ExecutionContext& context) {
  return Builder(chart, demand, max_leaves, context).build();
}

}  // namespace curvecast
