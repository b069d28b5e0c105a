// Memory of the progressive sampler for one view after the other: a frame that needs no more than those before allocates nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/progressive/rank_delta.h"
#include "core/progressive/rank_selection.h"
#include "core/sample/point_set.h"

namespace curvecast {

/// May be used for any curve, tree, density and number of points after any other. For one thread at a time.
struct RankedWorkspace {
  PointSet points;          // the last result of list_ranked() or gather_ranked()
  RankSelection selection;  // the last result of select_ranked()

  // Scratch of select_ranked().
  RankSelector selector{true};
  std::vector<float> density;
  // Scratch of list_ranked(), and for compare() and locate().
  std::vector<RankRef> shown, refs;
  std::vector<std::uint8_t> discs;
  RankDelta delta;
  ListDelta list_delta;

  /// Bytes allocated, in use or not; the selection's tree is shared and not counted.
  std::size_t byte_size() const;
};

}  // namespace curvecast
