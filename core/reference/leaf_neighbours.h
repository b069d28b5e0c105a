// Which leaves of the adaptive quadtree lie next to each other in the parameter square (paper, section 3.4). Nothing is stored:
// a place's Hilbert index is looked up among the sorted keys, and neighbours in the square are mostly near on the curve.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/curve/hilbert.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// The leaves of one disc in curve order: spans of a QuadtreeLeaves or of a SurfaceCurve. At most kNone of them.
struct LeafKeys {
  std::span<const std::uint64_t> key;
  std::span<const std::uint8_t> level;
};

/// Returns the eight neighbours, counter-clockwise from the right: the leaves that hold the cells at kMaxLevel just beyond the
/// middle of the right side, the upper right corner, the middle of the upper side ... A middle between two cells counts as the
/// right or upper one. Larger leaves may come more than once; kNone over the border of the square, and where no leaf is.
std::array<std::uint32_t, 8> leaf_neighbours(const LeafKeys& leaves, std::uint32_t leaf);

/// A place next to a leaf's border, counter-clockwise from the lower end of its right side.
struct RingEntry {
  std::uint32_t leaf;  // kNone beyond the border of the square, and where no leaf is
  bool is_corner;      // beyond a corner of the leaf, not beyond a side
  HilbertCell cell;    // at kMaxLevel: the place
};

/// Replaces `ring` by all leaves that touch the leaf: for each side those along it, one or more, then the one beyond the corner
/// at its end. Each side has one entry at least, each corner just one, which may be the same leaf as the entry before or after
/// it.
/// Returns the leaf's own lower left cell.
HilbertCell leaf_ring(const LeafKeys& leaves, std::uint32_t leaf, std::vector<RingEntry>& ring);

}  // namespace curvecast
