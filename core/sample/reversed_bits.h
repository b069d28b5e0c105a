// Numbers with their binary digits in reverse: van der Corput's order.
#pragma once

#include <cstdint>

namespace curvecast {

/// The lowest `bits` bits of i in reverse order. 0 <= bits <= 64, i < 2^bits.
constexpr std::uint64_t reversed_bits(std::uint64_t i, int bits) {
  std::uint64_t reversed = 0;
  for (int b = 0; b < bits; ++b) reversed |= (i >> b & 1) << (bits - 1 - b);
  return reversed;
}

}  // namespace curvecast
