// SPDX-License-Identifier: Apache-2.0
// Decodes the Draco point clouds that our servers send, several times as fast as Draco's own decoder: points one after the other
// (Draco's sequential method), quantised positions, octahedral normals, one-byte radii, one-byte colours, all as differences.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <string_view>

#include "client/lib/draco/draco_header.h"
#include "client/lib/draco/point_columns.h"
#include "client/lib/draco/symbol_reader.h"

namespace curvecast::client {

/// Keeps tables and memory from cloud to cloud. Not thread-safe.
class DracoReader {
 public:
  /// Writes the points of a cloud with this header to columns of header.points elements: normals and colours exactly where the
  /// header has them, radii only where it has a GENERIC attribute and `radii` is valid. The values equal those of Draco's decoder
  /// to the bit. False: this is another kind of Draco data, and nothing was written. InvalidArgument when it is broken, ends too
  /// early, its values leave the bounds that it states, or are not finite.
  absl::StatusOr<bool> read(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii, const PointColumns& to);

 private:
  static constexpr std::size_t kPart = 256;  // points at a time: they stay in the fastest cache

  /// What the bytes say about one attribute.
  struct Source {
    bool present = false;
    std::size_t components = 0;
    SymbolReader symbols;
    std::int32_t min = 0, max = 0;  // of differences that wrap around
    int bits = 0;                   // of a quantised one
    std::array<float, 3> low{};     // of positions
    float range = 0;
    std::array<std::uint32_t, 4 * kPart + 3> part{};  // the symbols of the points at hand
  };

  absl::StatusOr<bool> read_sources(std::string_view bytes, const DracoHeaderInfo& header);
  absl::StatusOr<bool> read_symbols(ByteReader& bytes, DracoKind kind, std::size_t points);
  absl::Status read_quantisation(ByteReader& bytes, DracoKind kind);
  absl::Status read_values(std::size_t points, RadiusRange radii, const PointColumns& to);
  void read_part(std::size_t count);

  Source& source(DracoKind kind);

  Source position_, normal_, radius_, colour_;
  RadiusRange range_;  // of radii_
  std::array<float, 256> radii_{};
};

}  // namespace curvecast::client
