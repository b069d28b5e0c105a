// Positions as points of a cubic lattice, rounded to the nearest as Draco does.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <span>

#include "core/base/vec.h"

namespace curvecast {

struct Lattice {
  Vec3f low = Vec3f::Zero();  // a corner of the box that it fills
  float size = 1;             // of a side, > 0
  int bits = 11;              // 1 .. 30: steps divide a side into 2^bits - 1
  bool is_centred = false;    // coordinates count from (0, 0, 0) and may be negative; else from `low`, and are not

  /// Returns the place where all coordinates are 0.
  Vec3f zero() const { return is_centred ? Vec3f::Zero() : low; }
};

/// InvalidArgument where a lattice is too small to have a finite number of steps in a unit of length.
absl::Status check_lattice(const Lattice& lattice);

/// Coordinates x, y, z of point after point into `coordinates`, which has room for three per position. What lies outside by no
/// more than a thousandth of the size, as rounding has it, is put on the side. InvalidArgument for places further outside.
/// Precondition: check_lattice() is content.
absl::Status to_lattice(const Lattice& lattice, std::span<const Vec3f> positions, std::span<std::int32_t> coordinates);

}  // namespace curvecast
