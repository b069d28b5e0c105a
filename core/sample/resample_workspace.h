// Memory for one view after the other: nothing is allocated for a frame that needs no more than those before.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/sample/equalise.h"
#include "core/sample/point_set.h"
#include "core/sample/rank_delta.h"
#include "core/sample/rank_selection.h"
#include "core/sample/view_mass.h"

namespace curvecast {

/// Takes any curve, density and number of points after any other. For one thread at a time.
struct ResampleWorkspace {
  PointSet points;  // the last result

  // resample()'s own affair.
  std::vector<double> sequence;
  ViewMass mass;
  EqualiseScratch equalise;
  // select_ranked()'s own affair but for the selection.
  RankSelector selector;
  RankSelection selection;
  std::vector<float> density;
  // list_ranked()'s own affair; and memory for who compares selections.
  std::vector<RankRef> shown, refs;
  std::vector<std::uint8_t> discs;
  RankDelta delta;
  ListDelta list_delta;

  /// Held, whether in use or not.
  std::size_t byte_size() const;
};

}  // namespace curvecast
