#include "core/reference/leaf_neighbours.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace curvecast {
namespace {

constexpr std::uint32_t kCells = std::uint32_t{1} << kMaxLevel;  // along a side of the square

/// One level of the way down: [state][quadrant] -> place on the curve | state of the child << 2, and back.
struct Steps {
  std::uint8_t to_place[4][4];
  std::uint8_t to_quadrant[4][4];  // [state][place] -> quadrant | state << 2
};

constexpr Steps make_steps() {
  Steps steps{};
  for (unsigned state = 0; state < 4; ++state) {
    for (unsigned place = 0; place < 4; ++place) {
      const unsigned quadrant = hilbert_quadrant(static_cast<HilbertState>(state), place);
      const unsigned child = hilbert_child_state(static_cast<HilbertState>(state), place);
      steps.to_place[state][quadrant] = static_cast<std::uint8_t>(place | child << 2);
      steps.to_quadrant[state][place] = static_cast<std::uint8_t>(quadrant | child << 2);
    }
  }
  return steps;
}

constexpr Steps kSteps = make_steps();

/// The last leaf whose key is not above `key`, searched for in steps that double, away from leaf `near`; kNone if there is none.
std::uint32_t last_not_above(std::span<const std::uint64_t> keys, std::uint64_t key, std::size_t near) {
  std::size_t low = near;   // keys[low] <= key, once found
  std::size_t high = near;  // keys[high] > key, or the end
  std::size_t step = 1;
  if (keys[near] <= key) {
    for (high = near + 1; high < keys.size() && keys[high] <= key; high = low + step) {
      low = high;
      step *= 2;
    }
    high = std::min(high, keys.size());
  } else {
    for (;; step *= 2) {
      if (high == 0) return kNone;
      low = high - std::min(high, step);
      if (keys[low] <= key) break;
      high = low;
    }
  }
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (keys[middle] <= key ? low : high) = middle;
  }
  return static_cast<std::uint32_t>(low);
}

bool holds(const LeafKeys& leaves, std::uint32_t leaf, std::uint64_t key) {
  return key - leaves.key[leaf] < std::uint64_t{1} << 2 * (kMaxLevel - leaves.level[leaf]);
}

/// Looks up places around one leaf. What a place's index has in common with the leaf's own is taken from there.
class Finder {
 public:
  Finder(const LeafKeys& leaves, std::uint32_t leaf) : leaves_(leaves), leaf_(leaf), level_(leaves.level[leaf]) {
    const std::uint64_t key = leaves.key[leaf];
    HilbertState state = 0;
    for (int l = 0; l < level_; ++l) {
      state_[l] = state;
      const unsigned step = kSteps.to_quadrant[state][key >> 2 * (kMaxLevel - 1 - l) & 3];
      x_ = x_ << 1 | (step & 1);
      y_ = y_ << 1 | (step >> 1 & 1);
      state = static_cast<HilbertState>(step >> 2);
    }
    state_[level_] = state;
    x_ <<= kMaxLevel - level_;
    y_ <<= kMaxLevel - level_;
  }

  // The leaf's lower left cell, and how many cells its side has.
  std::uint32_t x() const { return x_; }
  std::uint32_t y() const { return y_; }
  std::uint32_t side() const { return std::uint32_t{1} << (kMaxLevel - level_); }

  /// Coordinates left of or below zero have wrapped around.
  std::uint32_t at(std::uint32_t x, std::uint32_t y) const {
    if (x >= kCells || y >= kCells) return kNone;
    // Levels that the place shares with the leaf.
    const std::uint32_t difference = (x ^ x_) | (y ^ y_);
    int level = std::min(std::countl_zero(difference) - (32 - kMaxLevel), level_);
    HilbertState state = state_[level];
    const int first_below = kMaxLevel - level;
    std::uint64_t key = level == 0 ? 0 : leaves_.key[leaf_] >> 2 * first_below << 2 * first_below;
    const auto descend_to = [&](int wanted) {
      for (; level < wanted; ++level) {
        const int shift = kMaxLevel - 1 - level;
        const unsigned step = kSteps.to_place[state][(x >> shift & 1) | (y >> shift & 1) << 1];
        key |= std::uint64_t{step & 3} << 2 * shift;
        state = static_cast<HilbertState>(step >> 2);
      }
    };
    // As deep as the leaf itself, and only then deeper, where there are smaller leaves. Among leaves of one size the difference
    // of the keys tells the place: no search.
    descend_to(level_);
    const auto apart = static_cast<std::int64_t>(key - leaves_.key[leaf_]) >> 2 * (kMaxLevel - level_);
    const auto last = static_cast<std::int64_t>(leaves_.key.size()) - 1;
    auto near = static_cast<std::uint32_t>(std::clamp(static_cast<std::int64_t>(leaf_) + apart, std::int64_t{0}, last));
    for (;; descend_to(level + 1)) {
      const std::uint32_t found = last_not_above(leaves_.key, key, near);
      if (found != kNone) {
        if (leaves_.level[found] <= level && holds(leaves_, found, key)) return found;
        near = found;
      }
      if (level == kMaxLevel) return kNone;
    }
  }

 private:
  const LeafKeys& leaves_;
  std::uint32_t leaf_;
  int level_;
  std::uint32_t x_ = 0, y_ = 0;
  std::array<HilbertState, kMaxLevel + 1> state_;  // of the leaf's ancestors
};

}  // namespace

std::array<std::uint32_t, 8> leaf_neighbours(const LeafKeys& leaves, std::uint32_t leaf) {
  const Finder finder(leaves, leaf);
  const std::uint32_t side = finder.side();
  const std::uint32_t left = finder.x() - 1, middle_x = finder.x() + side / 2, right = finder.x() + side;
  const std::uint32_t below = finder.y() - 1, middle_y = finder.y() + side / 2, above = finder.y() + side;
  return {finder.at(right, middle_y), finder.at(right, above), finder.at(middle_x, above), finder.at(left, above),
          finder.at(left, middle_y),  finder.at(left, below),  finder.at(middle_x, below), finder.at(right, below)};
}

HilbertCell leaf_ring(const LeafKeys& leaves, std::uint32_t leaf, std::vector<RingEntry>& ring) {
  const Finder finder(leaves, leaf);
  const std::uint32_t side = finder.side(), x = finder.x(), y = finder.y();
  const std::uint32_t left = x - 1, right = x + side, below = y - 1, above = y + side;
  ring.clear();
  // What is along a side, from `start` on, which moves up or down: `cell_at` makes the place a cell.
  const auto add_side = [&](std::uint32_t start, std::uint32_t low, bool is_ascending, auto&& cell_at) {
    for (std::uint32_t place = start; place - low < side;) {
      const HilbertCell cell = cell_at(place);
      const std::uint32_t found = finder.at(cell.x, cell.y);
      ring.push_back({found, false, cell});
      if (found == kNone) return;
      const std::uint32_t cells = std::uint32_t{1} << (kMaxLevel - leaves.level[found]);
      const std::uint32_t first = place & ~(cells - 1);
      place = is_ascending ? first + cells : first - 1;
    }
  };
  const auto add_corner = [&](std::uint32_t corner_x, std::uint32_t corner_y) {
    ring.push_back({finder.at(corner_x, corner_y), true, {corner_x, corner_y}});
  };
  add_side(y, y, true, [&](std::uint32_t place) { return HilbertCell{right, place}; });
  add_corner(right, above);
  add_side(right - 1, x, false, [&](std::uint32_t place) { return HilbertCell{place, above}; });
  add_corner(left, above);
  add_side(above - 1, y, false, [&](std::uint32_t place) { return HilbertCell{left, place}; });
  add_corner(left, below);
  add_side(x, x, true, [&](std::uint32_t place) { return HilbertCell{place, below}; });
  add_corner(right, below);
  return {x, y};
}

}  // namespace curvecast
