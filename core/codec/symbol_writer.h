// Unsigned numbers as Draco's bitstream has them, in the shorter of two ways: "raw", an entropy code of the numbers themselves,
// or "tagged", an entropy code of the length in bits that the numbers of a point have in common, followed by their bits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/codec/byte_writer.h"
#include "core/codec/rans_writer.h"

namespace curvecast {

class SymbolWriter {
 public:
  /// `symbols` < 2^31, at least one, `components` (1 .. 3) for every point; they must outlive the writer.
  SymbolWriter(std::span<const std::uint32_t> symbols, int components);
  SymbolWriter(const SymbolWriter&) = delete;
  SymbolWriter& operator=(const SymbolWriter&) = delete;

  /// Returns the run that is to be coded, together with those of other writers, before write().
  RansRun& run() { return run_; }
  void write(ByteWriter& bytes) const;

 private:
  std::span<const std::uint32_t> symbols_;
  int components_;
  int table_bits_ = 0;               // of the distinct symbols' number, as the message says them; raw only
  std::vector<std::uint32_t> tags_;  // one for every point; empty: raw
  std::optional<RansTable> table_;
  RansRun run_{};
};

}  // namespace curvecast
