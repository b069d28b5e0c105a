// What one selection of ranked candidates shows and another does not.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sample/rank_selection.h"

namespace curvecast {

struct RankRef {
  std::uint32_t chunk;  // of the selection's tree
  std::uint32_t point;  // of the chunk
};

/// All points that a selection shows: chunk by chunk, each along the curve. What `out` held before is lost.
void list_shown(const RankSelection& selection, std::vector<RankRef>& out);

struct RankDelta {
  std::vector<RankRef> added;          // of the later selection's tree
  std::vector<std::uint32_t> removed;  // ranks
};

/// The trees may differ as far as the one has grown from the other.
void compare(const RankSelection& earlier, const RankSelection& later, RankDelta& out);

}  // namespace curvecast
