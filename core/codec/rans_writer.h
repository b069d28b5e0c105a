// Range coding with asymmetric numeral systems (rANS; Duda 2013) as Draco's bitstream has it: symbols from the last to the first
// into one state, which gives off a byte whenever it would become too large.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/codec/byte_writer.h"

namespace curvecast {

/// What every symbol costs: probabilities in units of 2^-precision_bits that add up to 1.
class RansTable {
 public:
  /// `counts` of the symbols 0, 1, ..., the last one's > 0, of which at most 2^precision_bits are > 0; precision_bits: 12 .. 20.
  RansTable(std::span<const std::uint32_t> counts, int precision_bits);

  /// The table as a decoder reads it.
  void write(ByteWriter& bytes) const;

 private:
  friend class RansCoder;
  /// How a symbol changes the state x, where d = probability * 256^k for the fewest bytes k that it always gives off.
  struct Step {
    std::uint64_t inverse;     // of d, in units of 2^-64, rounded up: gives floor(x / d) for all x < 2^30
    std::uint32_t last;        // the largest state for which it is k; k + 1 above
    std::uint32_t start;       // the probabilities of all symbols below
    std::uint32_t complement;  // 1 - probability
    std::uint32_t bits;        // 8 k
  };

  int precision_bits_;
  std::vector<std::uint32_t> probabilities_;
  std::vector<Step> steps_;
};

/// Symbols to be coded, and the bytes that come of it.
struct RansRun {
  const RansTable* table;
  std::span<const std::uint32_t> symbols;  // none that the table's counts had as 0
  std::unique_ptr<std::uint8_t[]> buffer;
  std::size_t size = 0;  // bytes of `buffer` that are the code

  std::span<const std::uint8_t> code() const { return {buffer.get(), size}; }
};

/// Codes all runs, two at a time: within a run every symbol waits for the one before.
void code_runs(std::span<RansRun* const> runs);

}  // namespace curvecast
