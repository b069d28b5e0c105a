// Positions as points of a cubic lattice, rounded to the nearest as Draco does.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <span>

#include "core/base/vec.h"

namespace curvecast {

struct Lattice {
  Vec3f low = Vec3f::Zero();  // the corner where all coordinates are 0
  float size = 1;             // of a side, > 0
  int bits = 11;              // 1 .. 30: coordinates go from 0 to 2^bits - 1
};

/// InvalidArgument where a lattice is too small to have a finite number of steps in a unit of length.
absl::Status check_lattice(const Lattice& lattice);

/// Coordinates x, y, z of point after point into `coordinates`, which has room for three per position. What lies outside by no
/// more than a thousandth of the size, as rounding has it, is put on the side. InvalidArgument for places further outside.
/// Precondition: check_lattice() is content.
absl::Status to_lattice(const Lattice& lattice, std::span<const Vec3f> positions, std::span<std::int32_t> coordinates);

}  // namespace curvecast
