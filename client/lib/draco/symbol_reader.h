// SPDX-License-Identifier: Apache-2.0
// Reads the whole numbers of a Draco attribute: as bytes, entropy-coded, or as bits whose number is entropy-coded.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "client/lib/draco/byte_reader.h"
#include "client/lib/draco/rans_reader.h"

namespace curvecast::client {

/// Keeps its memory from attribute to attribute: a byte per point at most, beside RansReader's. Not thread-safe.
class SymbolReader {
 public:
  /// Takes `points` times `components` symbols off the front of `bytes`, which must outlive the reading. InvalidArgument when
  /// they are broken or not all there.
  absl::Status open(ByteReader& bytes, std::size_t points, std::size_t components);

  /// Those of the next `points`.
  void read(std::size_t points, std::uint32_t* symbols);

  /// As RansReader::had_enough().
  bool had_enough() const { return coding_ != Coding::kEntropy || rans_.had_enough(); }

  /// What RansReader::read_together() takes, or null.
  RansReader* entropy() { return coding_ == Coding::kEntropy ? &rans_ : nullptr; }

 private:
  enum class Coding { kBytes, kEntropy, kTagged };

  absl::Status open_bytes(ByteReader& bytes, std::size_t points);
  absl::Status open_entropy(ByteReader& bytes);
  absl::Status open_tagged(ByteReader& bytes, std::size_t points);
  void read_bytes(std::size_t points, std::uint32_t* symbols);
  void read_tagged(std::size_t points, std::uint32_t* symbols);

  Coding coding_ = Coding::kBytes;
  std::size_t components_ = 0;
  RansReader rans_;
  std::span<const std::uint8_t> data_;  // bytes or bits
  std::size_t width_ = 0;               // bytes per symbol
  std::vector<std::uint8_t> tags_;      // bits per symbol, of every point
  std::size_t point_ = 0, bit_ = 0;     // where the tagged ones have come to
};

}  // namespace curvecast::client
