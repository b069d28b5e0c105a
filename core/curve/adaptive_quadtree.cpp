#include "core/curve/adaptive_quadtree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

namespace curvecast {
namespace {

struct Node {
  double x, y;
  std::uint64_t index;  // Hilbert index at its level
  int level;
  HilbertState state;
};

double side_of(int level) { return 1.0 / static_cast<double>(std::uint64_t{1} << level); }

Node child_of(const Node& node, unsigned i) {
  const double half = side_of(node.level + 1);
  const unsigned quadrant = hilbert_quadrant(node.state, i);
  return {node.x + (quadrant & 1) * half, node.y + (quadrant >> 1) * half, node.index << 2 | i, node.level + 1,
          hilbert_child_state(node.state, i)};
}

/// The level at which quads are small enough for a demand per unit of uv area.
std::uint8_t level_for(double demand) {
  if (!(demand > 1)) return 0;
  int exponent = 0;
  const double mantissa = std::frexp(demand, &exponent);  // in [0.5, 1)
  const int bits = mantissa == 0.5 ? exponent - 1 : exponent;
  return static_cast<std::uint8_t>(std::min((bits + 1) / 2, kMaxLevel));
}

/// Triangles near a node, and the deepest level that one of them wants.
struct Near {
  std::span<const std::uint32_t> triangles;
  int level = 0;
};

/// A triangle's list of neighbours divides into four, of which any may take all of it.
struct Quarters {
  std::vector<std::uint32_t> entries;
  std::array<std::size_t, 4> size{};
  std::array<int, 4> level{};

  void reset(std::size_t n) {
    if (entries.size() < 4 * n) entries.resize(4 * n);
    capacity_ = n;
    size.fill(0);
    level.fill(0);
  }
  void add(unsigned quadrant, std::uint32_t t, int wanted) {
    entries[quadrant * capacity_ + size[quadrant]++] = t;
    level[quadrant] = std::max(level[quadrant], wanted);
  }
  Near near(unsigned quadrant) const { return {{entries.data() + quadrant * capacity_, size[quadrant]}, level[quadrant]}; }

 private:
  std::size_t capacity_ = 0;
};

/// Leaves of a part of the curve.
struct Piece {
  std::vector<std::uint64_t> key;
  std::vector<std::uint8_t> level;
  std::vector<std::uint32_t> count;  // of triangles
  std::vector<std::uint32_t> triangles;
  std::size_t uncounted = 0;  // leaves that the builder's count does not know of yet
};

class Builder {
 public:
  Builder(std::span<const ParameterTriangle> triangles, std::span<const double> demand, std::size_t max_leaves,
          const ExecutionContext& context)
      : triangles_(triangles), max_leaves_(max_leaves), context_(context), wanted_(triangles.size()) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 4096), [&](const auto& range) {
      for (std::size_t t = range.begin(); t < range.end(); ++t) wanted_[t] = level_for(demand[t]);
    });
  }

  absl::StatusOr<QuadtreeLeaves> build() {
    for (;;) {
      leaf_count_ = 0;
      std::vector<Part> parts = divide();
      tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        Scratch scratch;
        grow(parts[i].node, parts[i].near(), scratch, parts[i].piece);
        parts[i].triangles = {};
      });
      if (absl::Status status = context_.check(); !status.ok()) return status;
      if (leaf_count_ <= max_leaves_) return join(parts);
      // One level less for those that want the most.
      const std::uint8_t cap = static_cast<std::uint8_t>(*std::max_element(wanted_.begin(), wanted_.end()) - 1);
      for (std::uint8_t& wanted : wanted_) wanted = std::min(wanted, cap);
    }
  }

 private:
  struct Part {
    Node node;
    std::vector<std::uint32_t> triangles;
    int level = 0;  // the deepest wanted
    Piece piece = {};

    Near near() const { return {triangles, level}; }
  };
  using Scratch = std::array<Quarters, kMaxLevel + 1>;

  // Parts of the square that are built independently: enough that threads share the work evenly. Neither number changes a leaf.
  static constexpr int kMostPartLevels = 12;
  static constexpr double kParts = 256;
  static constexpr double kSmallPart = 4096;

  /// What it takes to build a part, in leaves and triangles.
  double work(const Part& part) const {
    const double side = side_of(part.node.level);
    double leaves = 0;
    for (const std::uint32_t t : part.triangles) {
      const double area = std::min(triangles_[t].uv_area(), side * side);
      leaves += area * static_cast<double>(std::uint64_t{1} << 2 * wanted_[t]);
    }
    return leaves + static_cast<double>(part.triangles.size());
  }

  std::vector<Part> divide() const {
    std::vector<Part> parts(1);
    parts[0].node = {0, 0, 0, 0, 0};
    parts[0].triangles.resize(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) parts[0].triangles[t] = t;
    parts[0].level = *std::max_element(wanted_.begin(), wanted_.end());
    const double enough = std::max(work(parts[0]) / kParts, kSmallPart);
    for (int level = 0; level < kMostPartLevels; ++level) {
      std::vector<std::vector<Part>> children(parts.size());
      tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        Part& part = parts[i];
        if (part.level <= part.node.level || work(part) <= enough) {
          children[i].push_back(std::move(part));
          return;
        }
        Quarters quarters;
        distribute(part.node, part.near(), quarters);
        for (unsigned c = 0; c < 4; ++c) {
          const Near near = quarters.near(hilbert_quadrant(part.node.state, c));
          if (near.triangles.empty()) continue;
          children[i].push_back({child_of(part.node, c), {near.triangles.begin(), near.triangles.end()}, near.level});
        }
      });
      const std::size_t before = parts.size();
      parts.clear();
      for (std::vector<Part>& list : children) std::move(list.begin(), list.end(), std::back_inserter(parts));
      if (parts.size() == before) break;
    }
    return parts;
  }

  /// Hands a node's triangles to those of its quadrants that they touch (separating axes: the square's sides, then theirs).
  void distribute(const Node& node, const Near& near, Quarters& quarters) const {
    const double half = side_of(node.level + 1);
    const double mx = node.x + half, my = node.y + half;
    quarters.reset(near.triangles.size());
    for (const std::uint32_t t : near.triangles) {
      const ParameterTriangle& p = triangles_[t];
      const auto [min_u, max_u] = std::minmax({p.u[0], p.u[1], p.u[2]});
      const auto [min_v, max_v] = std::minmax({p.v[0], p.v[1], p.v[2]});
      const bool left = min_u <= mx, right = max_u >= mx, lower = min_v <= my, upper = max_v >= my;
      const int wanted = wanted_[t];
      if (left != right && lower != upper) {  // it reaches into the node, so into the one quadrant that its box meets
        quarters.add((right ? 1u : 0u) | (upper ? 2u : 0u), t, wanted);
        continue;
      }
      // Each side of the triangle leaves a quadrant out when the quadrant's corner farthest inwards is still outside.
      std::array<bool, 4> meets = {left && lower, right && lower, left && upper, right && upper};
      for (int i = 0; i < 3; ++i) {
        const int j = i == 2 ? 0 : i + 1;
        const double a = p.v[i] - p.v[j], b = p.u[j] - p.u[i];  // grows inwards
        const double centre = a * (mx - p.u[i]) + b * (my - p.v[i]);
        const double reach_left = std::max(-a * half, 0.0), reach_right = std::max(a * half, 0.0);
        const double reach_down = std::max(-b * half, 0.0), reach_up = std::max(b * half, 0.0);
        meets[0] = meets[0] && centre + reach_left + reach_down >= 0;
        meets[1] = meets[1] && centre + reach_right + reach_down >= 0;
        meets[2] = meets[2] && centre + reach_left + reach_up >= 0;
        meets[3] = meets[3] && centre + reach_right + reach_up >= 0;
      }
      for (unsigned quadrant = 0; quadrant < 4; ++quadrant) {
        if (meets[quadrant]) quarters.add(quadrant, t, wanted);
      }
    }
  }

  /// False when there are too many, or nobody wants them any more.
  bool count_leaves(std::size_t n) {
    if (context_.cancelled()) leaf_count_ = max_leaves_ + 1;
    n = std::min(n, max_leaves_ + 1);  // so that the sum cannot overflow
    return leaf_count_.fetch_add(n, std::memory_order_relaxed) + n <= max_leaves_;
  }

  void emit(const Node& node, const Near& near, Piece& piece) {
    piece.key.push_back(node.index << 2 * (kMaxLevel - node.level));
    piece.level.push_back(static_cast<std::uint8_t>(node.level));
    piece.count.push_back(static_cast<std::uint32_t>(near.triangles.size()));
    piece.triangles.insert(piece.triangles.end(), near.triangles.begin(), near.triangles.end());
    constexpr std::size_t kBatch = 1024;
    if (++piece.uncounted == kBatch) {
      count_leaves(kBatch);
      piece.uncounted = 0;
    }
  }

  /// All leaves below a node that lies within one triangle: nothing to test.
  void emit_grid(const Node& node, std::uint32_t t, int level, Piece& piece) {
    const std::size_t n = std::size_t{1} << 2 * (level - node.level);
    if (!count_leaves(n)) return;
    const std::uint64_t first = node.index << 2 * (kMaxLevel - node.level);
    const std::uint64_t step = std::uint64_t{1} << 2 * (kMaxLevel - level);
    const std::size_t begin = piece.key.size();
    piece.key.resize(begin + n);
    for (std::size_t i = 0; i < n; ++i) piece.key[begin + i] = first + i * step;
    piece.level.insert(piece.level.end(), n, static_cast<std::uint8_t>(level));
    piece.count.insert(piece.count.end(), n, 1u);
    piece.triangles.insert(piece.triangles.end(), n, t);
  }

  void grow(const Node& node, const Near& near, Scratch& scratch, Piece& piece) {
    if (leaf_count_.load(std::memory_order_relaxed) > max_leaves_) return;
    if (near.level <= node.level) {
      emit(node, near, piece);
      return;
    }
    if (near.triangles.size() == 1) {
      emit_grid(node, near.triangles[0], near.level, piece);
      return;
    }
    Quarters& quarters = scratch[node.level];
    distribute(node, near, quarters);
    for (unsigned i = 0; i < 4; ++i) {
      const Near inside = quarters.near(hilbert_quadrant(node.state, i));
      if (!inside.triangles.empty()) grow(child_of(node, i), inside, scratch, piece);
    }
  }

  static absl::StatusOr<QuadtreeLeaves> join(std::vector<Part>& parts) {
    std::vector<std::size_t> leaf_begin(parts.size() + 1, 0), triangle_begin(parts.size() + 1, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      leaf_begin[i + 1] = leaf_begin[i] + parts[i].piece.key.size();
      triangle_begin[i + 1] = triangle_begin[i] + parts[i].piece.triangles.size();
    }
    if (triangle_begin.back() > std::numeric_limits<std::uint32_t>::max()) {
      return absl::ResourceExhaustedError(
          "the curve's leaves would meet triangles more than 2^32 times: ask for fewer points, or simplify the mesh");
    }
    QuadtreeLeaves leaves;
    leaves.key.resize(leaf_begin.back());
    leaves.level.resize(leaf_begin.back());
    leaves.triangle_begin.resize(leaf_begin.back() + 1);
    leaves.triangles.resize(triangle_begin.back());
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
      const Piece piece = std::move(parts[i].piece);
      std::copy(piece.key.begin(), piece.key.end(), leaves.key.begin() + leaf_begin[i]);
      std::copy(piece.level.begin(), piece.level.end(), leaves.level.begin() + leaf_begin[i]);
      std::copy(piece.triangles.begin(), piece.triangles.end(), leaves.triangles.begin() + triangle_begin[i]);
      auto offset = static_cast<std::uint32_t>(triangle_begin[i]);
      for (std::size_t l = 0; l < piece.count.size(); ++l) {
        leaves.triangle_begin[leaf_begin[i] + l] = offset;
        offset += piece.count[l];
      }
    });
    leaves.triangle_begin[leaf_begin.back()] = static_cast<std::uint32_t>(triangle_begin.back());
    return leaves;
  }

  std::span<const ParameterTriangle> triangles_;
  std::size_t max_leaves_;
  const ExecutionContext& context_;
  std::vector<std::uint8_t> wanted_;  // level that each triangle wants of the leaves that it touches
  std::atomic<std::size_t> leaf_count_ = 0;
};

}  // namespace

Quad leaf_quad(std::uint64_t key, std::uint8_t level) {
  const HilbertCell cell = hilbert_cell(key >> 2 * (kMaxLevel - level), level);
  const double side = side_of(level);
  return {Vec2d(cell.x * side, cell.y * side), side};
}

absl::StatusOr<QuadtreeLeaves> build_quadtree(std::span<const ParameterTriangle> triangles, std::span<const double> demand,
                                              std::size_t max_leaves, const ExecutionContext& context) {
  return Builder(triangles, demand, max_leaves, context).build();
}

}  // namespace curvecast
