// Counts the points that a selection shows on the first part of the curve, without listing the points.
#pragma once

#include <cstdint>
#include <span>

#include "core/progressive/rank_selection.h"

namespace curvecast {

/// Sets before[i] to the number of selected points whose RankChunk::curve_position is below curve_positions[i]. curve_positions
/// ascend; `before` has as many entries. Takes a step for each chunk of the selection, and a few for each level and curve
/// position: not one for each point.
void count_selected_before(const RankSelection& selection, std::span<const std::uint64_t> curve_positions,
                           std::span<std::uint32_t> before);

}  // namespace curvecast
