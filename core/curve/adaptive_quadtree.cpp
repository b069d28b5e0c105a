#include "core/curve/adaptive_quadtree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/mutex.h"
#include "core/base/simd.h"
#include "core/curve/triangle_bins.h"

namespace curvecast {
namespace {

struct Node {
  std::uint64_t key;   // Hilbert index of its first cell at kMaxLevel, where
  std::uint32_t x, y;  // its lower left corner is this cell
  int level;
  HilbertState state;
};

inline Node child_of(const Node& node, unsigned i) {
  const int level = node.level + 1;
  const unsigned quadrant = hilbert_quadrant(node.state, i);
  return {node.key + (std::uint64_t{i} << 2 * (kMaxLevel - level)), node.x + ((quadrant & 1) << (kMaxLevel - level)),
          node.y + ((quadrant >> 1) << (kMaxLevel - level)), level, hilbert_child_state(node.state, i)};
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
    if (entries.size() <= 4 * n) entries.resize(4 * n + 1);
    capacity_ = n;
  }
  Near near(unsigned quadrant) const { return {{entries.data() + quadrant * capacity_, size[quadrant]}, level[quadrant]}; }

 private:
  std::size_t capacity_ = 0;
};

/// Leaves of a part of the curve.
struct Piece {
  struct Leaf {
    std::uint64_t key;
    std::uint32_t x, y;
    std::uint32_t triangles;  // how many
    std::uint8_t level;
  };
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> triangles;
  std::size_t uncounted = 0;  // leaves that the builder's count does not know of yet

  void add(const Node& leaf, std::size_t count) {
    leaves.push_back({leaf.key, leaf.x, leaf.y, static_cast<std::uint32_t>(count), static_cast<std::uint8_t>(leaf.level)});
  }
};

/// Hands a node's triangles to those of its quadrants that they touch (separating axes: the square's sides, then theirs).
CURVECAST_WIDE void distribute(const ParameterTriangle* triangles, const std::uint8_t* wanted, const Node& node,
                               const std::uint32_t* first, std::size_t count, Quarters& quarters) {
  const double half = side_of_level(node.level + 1), quarter = 0.5 * half;
  const double mx = node.x * kCellSide + half, my = node.y * kCellSide + half;
  quarters.reset(count);
  std::uint32_t* out = quarters.entries.data();
  Mask4 size{};
  Mask4 level{};
  // Lanes are quadrants: bit 0 = right half, bit 1 = upper half.
  const Double4 zero{}, sign_x{-1, 1, -1, 1}, sign_y{-1, -1, 1, 1};
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t t = first[i];
    const ParameterTriangle& p = triangles[t];
    const double below_x = mx - fast_min(fast_min(p.u[0], p.u[1]), p.u[2]),
                 above_x = fast_max(fast_max(p.u[0], p.u[1]), p.u[2]) - mx;
    const double below_y = my - fast_min(fast_min(p.v[0], p.v[1]), p.v[2]),
                 above_y = fast_max(fast_max(p.v[0], p.v[1]), p.v[2]) - my;
    const Double4 reach_x{below_x, above_x, below_x, above_x}, reach_y{below_y, below_y, above_y, above_y};
    Double4 inside = reach_x < reach_y ? reach_x : reach_y;
    for (int s = 0; s < 3; ++s) {
      // How far the quadrant's corner that lies farthest inwards is on the inner side of this side.
      const int e = s == 2 ? 0 : s + 1;
      const double a = p.v[s] - p.v[e], b = p.u[e] - p.u[s];
      const double step_x = a * quarter, step_y = b * quarter;
      const double farthest = a * (mx - p.u[s]) + b * (my - p.v[s]) + (std::abs(step_x) + std::abs(step_y));
      const Double4 reach = farthest + sign_x * step_x + sign_y * step_y;
      inside = inside < reach ? inside : reach;
    }
    const Mask4 meets = inside >= zero;
    for (std::size_t quadrant = 0; quadrant < 4; ++quadrant) {
      out[quadrant * count + static_cast<std::size_t>(size[quadrant])] = t;
    }
    size -= meets;
    const Mask4 wants = meets & static_cast<std::int64_t>(wanted[t]);
    level = level > wants ? level : wants;
  }
  for (unsigned quadrant = 0; quadrant < 4; ++quadrant) {
    quarters.size[quadrant] = static_cast<std::size_t>(size[quadrant]);
    quarters.level[quadrant] = static_cast<int>(level[quadrant]);
  }
}

class Builder {
 public:
  Builder(std::span<const ParameterTriangle> triangles, std::span<const double> demand, std::size_t max_leaves,
          const ExecutionContext& context, const LeavesClaim& claim)
      : triangles_(triangles), max_leaves_(max_leaves), context_(context), claim_(claim), wanted_(triangles.size()) {
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
        count_leaves(parts[i].piece.uncounted);
      });
      if (absl::Status status = context_.check(); !status.ok()) return status;
      if (absl::Status status = refusal(); !status.ok()) return status;
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
    int level = 0;    // the deepest wanted
    double work = 0;  // see work_of
    Piece piece = {};

    Near near() const { return {triangles, level}; }
  };
  using Scratch = std::array<Quarters, kMaxLevel + 1>;

  // Parts of the square that are built independently: enough that threads share the work evenly. None of these numbers changes a
  // leaf.
  static constexpr int kGridLevel = 5;
  static constexpr int kMostRounds = 8;
  static constexpr double kParts = 256;
  static constexpr double kSmallPart = 4096;  // leaves and triangles

  /// What it takes to build a part, in leaves and triangles.
  double work_of(const Part& part) const {
    const double side = side_of_level(part.node.level);
    double leaves = 0;
    for (const std::uint32_t t : part.triangles) {
      const double area = std::min(triangles_[t].uv_area(), side * side);
      leaves += area * static_cast<double>(std::uint64_t{1} << 2 * wanted_[t]);
    }
    return leaves + static_cast<double>(part.triangles.size());
  }

  /// The whole square, or the cells of a grid where all of them are divided anyway.
  std::vector<Part> first_parts() const {
    const auto [least, most] = std::minmax_element(wanted_.begin(), wanted_.end());
    const int level = triangles_.size() < kSmallPart ? 0 : std::min<int>(*least, kGridLevel);
    std::vector<std::vector<std::uint32_t>> cells = bin_triangles(triangles_, level);
    std::vector<Part> parts;
    add_cells({}, level, cells, parts);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
      for (const std::uint32_t t : parts[i].triangles) parts[i].level = std::max<int>(parts[i].level, wanted_[t]);
      parts[i].work = work_of(parts[i]);
    });
    return parts;
  }

  static void add_cells(const Node& node, int level, std::vector<std::vector<std::uint32_t>>& cells, std::vector<Part>& parts) {
    if (node.level < level) {
      for (unsigned i = 0; i < 4; ++i) add_cells(child_of(node, i), level, cells, parts);
      return;
    }
    const int shift = kMaxLevel - level;
    std::vector<std::uint32_t>& cell = cells[(std::size_t{node.y} >> shift << level) + (node.x >> shift)];
    if (!cell.empty()) parts.push_back({node, std::move(cell)});
  }

  std::vector<Part> divide() const {
    std::vector<Part> parts = first_parts();
    double work = 0;
    for (const Part& part : parts) work += part.work;
    const double enough = std::max(work / kParts, kSmallPart);
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<std::vector<Part>> children(parts.size());
      tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        Part& part = parts[i];
        if (part.level <= part.node.level || part.work <= enough) {
          children[i].push_back(std::move(part));
          return;
        }
        Quarters quarters;
        distribute(triangles_.data(), wanted_.data(), part.node, part.triangles.data(), part.triangles.size(), quarters);
        for (unsigned c = 0; c < 4; ++c) {
          const Near near = quarters.near(hilbert_quadrant(part.node.state, c));
          if (near.triangles.empty()) continue;
          Part child{child_of(part.node, c), {near.triangles.begin(), near.triangles.end()}, near.level};
          child.work = work_of(child);
          children[i].push_back(std::move(child));
        }
      });
      const std::size_t before = parts.size();
      parts.clear();
      for (std::vector<Part>& list : children) std::move(list.begin(), list.end(), std::back_inserter(parts));
      if (parts.size() == before) break;
    }
    return parts;
  }

  /// False when there are too many, there is no memory for them, or nobody wants them any more.
  bool count_leaves(std::size_t n) {
    if (context_.cancelled()) leaf_count_ = max_leaves_ + 1;
    n = std::min(n, max_leaves_ + 1);  // so that the sum cannot overflow
    const std::size_t count = leaf_count_.fetch_add(n, std::memory_order_relaxed) + n;
    if (count > max_leaves_) return false;
    if (count > claimed_.load(std::memory_order_relaxed)) claim_more(count);
    return leaf_count_.load(std::memory_order_relaxed) <= max_leaves_;
  }

  void claim_more(std::size_t count) {
    if (!claim_) return;
    const MutexLock lock(mutex_);
    if (count <= claimed_ || !refusal_.ok()) return;
    refusal_ = claim_(count);
    if (refusal_.ok()) {
      claimed_ = count;
    } else {
      leaf_count_ = max_leaves_ + 1;  // which ends it
    }
  }

  absl::Status refusal() {
    const MutexLock lock(mutex_);
    return refusal_;
  }

  void emit(const Node& node, const Near& near, Piece& piece) {
    piece.add(node, near.triangles.size());
    for (const std::uint32_t t : near.triangles) piece.triangles.push_back(t);  // a few: not worth a call
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
    add_grid(node, level, piece);
    piece.triangles.insert(piece.triangles.end(), n, t);
  }

  static void add_grid(const Node& node, int level, Piece& piece) {
    if (node.level == level) {
      piece.add(node, 1);
      return;
    }
    for (unsigned i = 0; i < 4; ++i) add_grid(child_of(node, i), level, piece);
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
    distribute(triangles_.data(), wanted_.data(), node, near.triangles.data(), near.triangles.size(), quarters);
    for (unsigned i = 0; i < 4; ++i) {
      const Near inside = quarters.near(hilbert_quadrant(node.state, i));
      if (!inside.triangles.empty()) grow(child_of(node, i), inside, scratch, piece);
    }
  }

  static absl::StatusOr<QuadtreeLeaves> join(std::vector<Part>& parts) {
    std::vector<std::size_t> leaf_begin(parts.size() + 1, 0), triangle_begin(parts.size() + 1, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      leaf_begin[i + 1] = leaf_begin[i] + parts[i].piece.leaves.size();
      triangle_begin[i + 1] = triangle_begin[i] + parts[i].piece.triangles.size();
    }
    if (triangle_begin.back() > std::numeric_limits<std::uint32_t>::max()) {
      return absl::ResourceExhaustedError(
          "the curve's leaves would meet triangles more than 2^32 times: ask for fewer points, or simplify the mesh");
    }
    QuadtreeLeaves leaves;
    leaves.key.resize(leaf_begin.back());
    leaves.level.resize(leaf_begin.back());
    leaves.x.resize(leaf_begin.back());
    leaves.y.resize(leaf_begin.back());
    leaves.triangle_begin.resize(leaf_begin.back() + 1);
    leaves.triangles.resize(triangle_begin.back());
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
      const Piece piece = std::move(parts[i].piece);
      std::copy(piece.triangles.begin(), piece.triangles.end(), leaves.triangles.begin() + triangle_begin[i]);
      auto offset = static_cast<std::uint32_t>(triangle_begin[i]);
      std::size_t l = leaf_begin[i];
      for (const Piece::Leaf& leaf : piece.leaves) {
        leaves.key[l] = leaf.key;
        leaves.level[l] = leaf.level;
        leaves.x[l] = leaf.x;
        leaves.y[l] = leaf.y;
        leaves.triangle_begin[l] = offset;
        offset += leaf.triangles;
        ++l;
      }
    });
    leaves.triangle_begin[leaf_begin.back()] = static_cast<std::uint32_t>(triangle_begin.back());
    return leaves;
  }

  std::span<const ParameterTriangle> triangles_;
  std::size_t max_leaves_;
  const ExecutionContext& context_;
  const LeavesClaim& claim_;
  Mutex mutex_;
  absl::Status refusal_ ABSL_GUARDED_BY(mutex_);
  std::atomic<std::size_t> claimed_ = 0;  // leaves; grows under the mutex
  std::vector<std::uint8_t> wanted_;      // level that each triangle wants of the leaves that it touches
  std::atomic<std::size_t> leaf_count_ = 0;
};

}  // namespace

Quad leaf_quad(std::uint64_t key, std::uint8_t level) {
  const HilbertCell cell = hilbert_cell(key >> 2 * (kMaxLevel - level), level);
  const double side = side_of_level(level);
  return {Vec2d(cell.x * side, cell.y * side), side};
}

absl::StatusOr<QuadtreeLeaves> build_quadtree(std::span<const ParameterTriangle> triangles, std::span<const double> demand,
                                              std::size_t max_leaves, const ExecutionContext& context, const LeavesClaim& claim) {
  return Builder(triangles, demand, max_leaves, context, claim).build();
}

}  // namespace curvecast
