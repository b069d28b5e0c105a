// Numbers of any length in bits, one after the other; the lowest bit comes first.
#pragma once

#include <cstdint>

#include "core/codec/byte_writer.h"

namespace curvecast {

class BitWriter {
 public:
  /// Writes into `bytes`, which nobody else may do before finish().
  explicit BitWriter(ByteWriter& bytes) : bytes_(bytes) {}

  /// value < 2^length; length: 0 .. 32.
  void put(std::uint32_t value, int length) {
    waiting_ |= std::uint64_t{value} << count_;
    count_ += length;
    if (count_ < 32) return;
    bytes_.put(static_cast<std::uint32_t>(waiting_));
    waiting_ >>= 32;
    count_ -= 32;
  }

  /// The last byte is filled up with zeros.
  void finish() {
    for (; count_ > 0; count_ -= 8, waiting_ >>= 8) bytes_.put(static_cast<std::uint8_t>(waiting_));
    count_ = 0;
  }

 private:
  ByteWriter& bytes_;
  std::uint64_t waiting_ = 0;  // its lowest count_ bits are still to be written
  int count_ = 0;              // < 32 between calls
};

}  // namespace curvecast
