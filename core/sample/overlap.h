// Points that are too near to others, and how they get away from them.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/sample/point_blocks.h"

namespace curvecast {

/// Spacings: points that are nearer to one another than the smaller one of theirs by this are too near. Tried on ten models: by
/// more many stay too near where the surface bends, and their sets are less even.
inline constexpr float kApart = 0.8F;

struct Overlap {
  /// How far the points of the block should go: half of the ways, along their own planes, that part them from those too near.
  std::array<Vec3f, PointBlocks::kBlock> steps;
  /// Those of the block that are too near to others.
  std::bitset<PointBlocks::kBlock> is_found;
};

/// Looks at those points of a block whose `is_awake` is not 0, and sets `wakes` to 1 for them and for what is too near to them.
/// `apart_behind`: kApart or less, for points that face away from each other, as on both sides of a sheet. For any number of
/// threads at a time, each with its scratch. Source: Mueller, Heidelberger, Hennix, Ratcliff, "Position based dynamics" (2007),
/// section 3.3, with both points of equal mass.
Overlap find_overlap(const PointBlocks& points, std::size_t block, float apart_behind, const std::vector<std::uint8_t>& is_awake,
                     std::vector<std::uint8_t>& wakes, PointBlocks::Scratch& scratch);

/// Counts the points of a block that are too near to others that face away from them.
std::size_t count_too_near_behind(const PointBlocks& points, std::size_t block, PointBlocks::Scratch& scratch);

}  // namespace curvecast
