// How many of the points that a selection shows come before given places along the curve, without listing them.
#pragma once

#include <cstdint>
#include <span>

#include "core/progressive/rank_selection.h"

namespace curvecast {

/// before[i] = how many of the points shown have a lower RankChunk::place than places[i], which ascend.
/// before.size() = places.size(). Takes a step for each of the selection's chunks, and a few more for each of its levels and
/// place: not for each point.
void count_shown_before(const RankSelection& selection, std::span<const std::uint32_t> places, std::span<std::uint32_t> before);

}  // namespace curvecast
