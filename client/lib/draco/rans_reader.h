// SPDX-License-Identifier: Apache-2.0
// Decodes the entropy coding of Draco: rANS after J. Duda, "Asymmetric numeral systems" (2013), arXiv:1311.2540, byte by byte
// from the back, in the table layout of Draco's bitstream 2.
#pragma once

#include <absl/status/status.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "client/lib/draco/byte_reader.h"

namespace curvecast::client {

/// One stream of symbols. Keeps its memory from stream to stream; that grows with the bytes of a table, never with the counts
/// that they claim. Not thread-safe.
class RansReader {
 public:
  /// Takes a table of frequencies that sum to 2^precision_bits (12 .. 20), then a stream, off the front of `bytes`, which must
  /// outlive the reading. InvalidArgument when they are broken.
  absl::Status open(ByteReader& bytes, int precision_bits);

  /// The next `count` symbols. A broken stream gives arbitrary symbols of the table.
  void read(std::size_t count, std::uint32_t* symbols);

  /// False when symbols were read that the bytes did not hold. Ask after the last one.
  bool had_enough() const;

  /// Reads 3, 2 and 1 symbols of three streams `count` times: faster than one after the other, because a stream is one chain of
  /// dependent steps.
  static void read_together(const std::array<RansReader*, 3>& readers, std::size_t count,
                            const std::array<std::uint32_t*, 3>& symbols);

 private:
  /// What follows from the low bits of a state.
  struct Entry {
    std::uint16_t frequency, offset;
    std::uint32_t symbol;
  };
  /// A symbol that occurs, where its part of the low bits begins.
  struct Slot {
    std::uint32_t start, symbol;
  };
  struct Stream;
  struct NarrowStream;
  struct WideStream;
  struct SearchedStream;

  absl::Status read_table(ByteReader& bytes);
  void fill_narrow();
  void fill_wide();
  void index_slots();
  absl::Status start(ByteReader& bytes);
  /// Calls the function with the stream, as the table asks for.
  template <typename Function>
  void with_stream(Function&& function) const;
  void put_back(const Stream& stream);

  int precision_ = 0;        // bits
  std::vector<Slot> slots_;  // and one behind them
  // Whatever finds a slot soonest for that many of them and that precision; the others are empty.
  std::vector<std::uint32_t> narrow_;  // for every value of the low bits
  std::vector<Entry> wide_;            // for every value of the low bits
  std::vector<std::uint32_t> first_;   // the first slot for every value of the highest of the low bits

  std::uint32_t state_ = 0;
  const std::uint8_t *begin_ = nullptr, *end_ = nullptr;  // what is left of the stream
};

}  // namespace curvecast::client
