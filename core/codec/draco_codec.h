// Compresses point sets as Draco's sequential encoder does, byte for byte, but several times as fast: their order is kept, and
// every Draco decoder reads them. The bitstream is Draco's 2.3 for point clouds, https://google.github.io/draco/spec.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <string>

#include "core/sample/point_set.h"

namespace curvecast {

struct DracoOptions {
  int position_bits = 11;         // 1 .. 30 per coordinate, over the largest side of `box`
  int normal_bits = 8;            // 2 .. 30, octahedral
  Vec3d box_min = Vec3d::Zero();  // lattice of the positions, relative to points.origin: the same box for every frame of a
  double box_size = 1;            // session makes all frames share one lattice; > 0
  bool is_centred = false;        // the lattice counts from points.origin, not from box_min: floats are finest there
  double radius_max = 0;          // the top of the ladder of radii, none of which is larger; 0: the largest of the points'
};

/// Encodes points. The message holds position, normal and a generic one-byte attribute "radius": code c means
/// radius_min (radius_max / radius_min)^(c / 255), where both bounds are written to the arguments; radii are rounded up to a
/// RadiusLadder below radius_max, of which a rung is four codes. Where the points have colours, also COLOR, three bytes (alpha is
/// dropped: points of a surface are not blended). Coordinates on a lattice that is centred may be negative.
/// InvalidArgument for options out of range and points outside of the box.
absl::StatusOr<std::string> encode_draco(const PointSet& points, const DracoOptions& options, float* radius_min,
                                         float* radius_max);

/// Encodes points [begin, begin + count) alone.
absl::StatusOr<std::string> encode_draco(const PointSet& points, std::size_t begin, std::size_t count,
                                         const DracoOptions& options, float* radius_min, float* radius_max);

}  // namespace curvecast
