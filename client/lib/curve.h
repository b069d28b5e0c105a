// SPDX-License-Identifier: Apache-2.0
// The adaptive Hilbert curve of a session, in the parameter square and on the surface, as the server sends it.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::client {

/// The curve of one disc: L vertices in curve order. Each is the centre of a quad of the parameter square.
struct CurveDisc {
  std::vector<std::array<float, 3>> positions;       // L, in the file's units, relative to the origin
  std::vector<std::array<std::int16_t, 3>> normals;  // L, 1 = 32767
  std::vector<float> areas;                          // L: surface that the vertex stands for, squared units
  std::vector<std::array<std::uint32_t, 2>> cells;   // L: the quad's lower left corner, in units of 2^-30
  std::vector<std::uint8_t> levels;                  // L: the quad's side is 2^-level

  std::size_t size() const { return levels.size(); }
  /// Of the quad, in [0, 1].
  double side(std::size_t l) const;
  std::array<double, 2> centre(std::size_t l) const;
};

struct Curve {
  v1::CurveInfo info;
  std::vector<CurveDisc> discs;
};

/// Joins the chunks. DataLoss unless there are as many discs and vertices as announced, in order, with arrays of matching
/// lengths, finite numbers, areas that are not negative, and quads that are quads of the square at levels from 0 to 30.
absl::StatusOr<Curve> decode_curve(std::span<const v1::GetCurveResponse> responses);

}  // namespace curvecast::client
