// What Draco itself makes of points, for comparison.
#pragma once

#include <string>

#include "core/codec/draco_codec.h"

namespace curvecast::testing {

/// What encode_draco() gives for points within the box; the test fails where Draco does. Draco takes six decimals of the box, and
/// gigabytes of memory where neighbours' coordinates differ by millions.
std::string draco_reference(const PointSet& points, const DracoOptions& options);

}  // namespace curvecast::testing
