// Finds the squares of leaves that are visited in curve order, cheaper than leaf_quad() does for any leaf.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/curve/hilbert.h"

namespace curvecast {

/// Remembers the way from the square down to the last leaf: two leaves that follow each other share all of it but a level or so.
class LeafCursor {
 public:
  struct Square {
    double x, y;  // lower left corner
    double side;
  };

  Square operator()(std::uint64_t key, int level) {
    const std::uint64_t changed = key ^ key_;
    // Levels that still hold: those above the highest pair of bits that differs.
    const int shared = changed == 0 ? kMaxLevel : (2 * kMaxLevel - std::bit_width(changed)) / 2;
    for (int l = std::min(shared, known_) + 1; l <= level; ++l) {
      const auto i = static_cast<unsigned>(key >> 2 * (kMaxLevel - l)) & 3;
      const unsigned quadrant = hilbert_quadrant(state_[l - 1], i);
      x_[l] = x_[l - 1] << 1 | (quadrant & 1);
      y_[l] = y_[l - 1] << 1 | (quadrant >> 1);
      state_[l] = hilbert_child_state(state_[l - 1], i);
    }
    key_ = key;
    known_ = level;
    const double side = kSides[level];
    return {x_[level] * side, y_[level] * side, side};
  }

 private:
  static constexpr std::array<double, kMaxLevel + 1> kSides = [] {
    std::array<double, kMaxLevel + 1> sides{};
    for (int l = 0; l <= kMaxLevel; ++l) sides[l] = 1.0 / static_cast<double>(std::uint64_t{1} << l);
    return sides;
  }();

  std::uint64_t key_ = 0;
  int known_ = 0;  // levels of x_, y_ and state_ that belong to key_
  std::array<std::uint32_t, kMaxLevel + 1> x_{}, y_{};
  std::array<HilbertState, kMaxLevel + 1> state_{};
};

}  // namespace curvecast
