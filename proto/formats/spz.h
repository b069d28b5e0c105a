// SPDX-License-Identifier: Apache-2.0
// Splats as a .spz file of version 3, gzip within: what readers of all versions from 3 on take. Source: github.com/nianticlabs/spz.
#pragma once

#include <absl/status/statusor.h>

#include <string>

#include "proto/formats/splats.h"

namespace curvecast::formats {

/// Returns a .spz file; each of its columns is in order of rank. Axes are those of the mesh, with Y up for most readers. Positions are
/// relative to the origin, which the format has no place for, and whole multiples of the finest power of 2 for which 24 bits hold
/// them. Widths are rounded to 6 %, colours to 7 bits, rotations to 9 bits. InvalidArgument: as make_splats(); widths that are all
/// below e^-10 units or one above e^5.9 units, or a position beyond 2^23 units from the origin, which the format cannot say.
absl::StatusOr<std::string> make_spz(const PointColumns& columns);

}  // namespace curvecast::formats
