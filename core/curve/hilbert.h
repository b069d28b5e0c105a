// The Hilbert curve on a 2^level x 2^level grid: index <-> cell, and the state machine that walks a quadtree in curve order.
// Source: Butz, "Space filling curves and mathematical programming" (1968); paper, section 3.2.
#pragma once

#include <cstdint>

namespace curvecast {

/// Deepest quadtree level; an index takes 2 bits a level.
inline constexpr int kMaxLevel = 30;

/// A cell of the grid: x, y in [0, 2^level).
struct HilbertCell {
  std::uint32_t x, y;
};

/// How the curve lies in a quad: bit 0 = mirrored in the diagonal, bit 1 = turned by half. The whole square has state 0: from the
/// lower left corner to the lower right one.
using HilbertState = std::uint8_t;

/// Quadrant that the curve visits as its i-th (0 .. 3) in a quad of the given state: bit 0 = right half, bit 1 = upper half.
constexpr unsigned hilbert_quadrant(HilbertState state, unsigned i) {
  constexpr unsigned kBase[4] = {0b00, 0b10, 0b11, 0b01};
  unsigned quadrant = kBase[i];
  if (state & 1) quadrant = ((quadrant & 1) << 1) | (quadrant >> 1);
  return state & 2 ? quadrant ^ 3 : quadrant;
}

/// State of that quadrant.
constexpr HilbertState hilbert_child_state(HilbertState state, unsigned i) {
  constexpr HilbertState kTurn[4] = {1, 0, 0, 3};
  return static_cast<HilbertState>(state ^ kTurn[i]);
}

/// Cell of an index at a level, 0 <= level <= kMaxLevel, index < 4^level.
constexpr HilbertCell hilbert_cell(std::uint64_t index, int level) {
  HilbertCell cell{0, 0};
  HilbertState state = 0;
  for (int l = level - 1; l >= 0; --l) {
    const auto i = static_cast<unsigned>(index >> (2 * l)) & 3;
    const unsigned quadrant = hilbert_quadrant(state, i);
    cell.x = cell.x << 1 | (quadrant & 1);
    cell.y = cell.y << 1 | (quadrant >> 1);
    state = hilbert_child_state(state, i);
  }
  return cell;
}

/// The inverse of hilbert_cell.
constexpr std::uint64_t hilbert_index(HilbertCell cell, int level) {
  std::uint64_t index = 0;
  HilbertState state = 0;
  for (int l = level - 1; l >= 0; --l) {
    const unsigned quadrant = (cell.x >> l & 1) | (cell.y >> l & 1) << 1;
    unsigned i = 0;
    while (hilbert_quadrant(state, i) != quadrant) ++i;
    index = index << 2 | i;
    state = hilbert_child_state(state, i);
  }
  return index;
}

}  // namespace curvecast
