// Directions as points of an octahedron that is unfolded to a square lattice, and the way from one to the next as two small
// unsigned numbers, as Draco's "canonicalised normal octahedron" transform has them: the square is inverted and turned so that
// the point before lies in the lower left of the half that is seen. After Meyer, Süßmuth, Sußner, Stamminger, Greiner 2010, "On
// floating-point normal vectors", and Draco's bitstream.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/vec.h"

namespace curvecast {

/// The lattice has 2^bits - 1 points a side, of which the middle one, `center`, is (1, 0, 0).
struct OctahedralLattice {
  explicit OctahedralLattice(int bits) : modulus((1 << bits) - 1), center((modulus - 1) / 2) {}  // 2 .. 30
  std::int32_t modulus, center;
};

/// Two symbols < modulus for every normal; the first one's predecessor is the lattice's point (0, 0). What has no direction
/// (zero, not finite) counts as (1, 0, 0). `symbols` has room for two per normal.
void octahedral_symbols(const OctahedralLattice& lattice, std::span<const Vec3f> normals, std::span<std::uint32_t> symbols);

}  // namespace curvecast
