// Numbers with their binary digits in reverse: van der Corput's order.
#pragma once

#include <cstdint>

namespace curvecast {

/// The lowest `bits` bits of i in reverse order. 0 <= bits <= 64, i < 2^bits.
constexpr std::uint64_t reversed_bits(std::uint64_t i, int bits) {
  // Neighbouring bits change places, then pairs of them, and so on.
  i = (i & 0x5555555555555555u) << 1 | (i >> 1 & 0x5555555555555555u);
  i = (i & 0x3333333333333333u) << 2 | (i >> 2 & 0x3333333333333333u);
  i = (i & 0x0f0f0f0f0f0f0f0fu) << 4 | (i >> 4 & 0x0f0f0f0f0f0f0f0fu);
  i = (i & 0x00ff00ff00ff00ffu) << 8 | (i >> 8 & 0x00ff00ff00ff00ffu);
  i = (i & 0x0000ffff0000ffffu) << 16 | (i >> 16 & 0x0000ffff0000ffffu);
  i = i << 32 | i >> 32;
  return bits == 0 ? 0 : i >> (64 - bits);
}

}  // namespace curvecast
