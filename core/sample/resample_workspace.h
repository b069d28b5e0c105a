// Memory of the equalised sampler for one view after the other: a frame that needs no more than those before allocates nothing.
#pragma once

#include <cstddef>
#include <vector>

#include "core/sample/equalise.h"
#include "core/sample/point_set.h"
#include "core/sample/view_mass.h"

namespace curvecast {

/// May be used for any curve, density and number of points after any other. For one thread at a time.
struct ResampleWorkspace {
  PointSet points;  // the last result

  // Scratch of resample().
  std::vector<double> sequence;
  ViewMass mass;
  EqualiseScratch equalise;

  /// Bytes allocated, in use or not.
  std::size_t byte_size() const;
};

}  // namespace curvecast
