// Scalars out of unaligned bytes of either byte order.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace curvecast {

static_assert(std::endian::native == std::endian::little, "the readers take little endian for the machine's own order");

/// Returns the T at `p`, its bytes reversed first if kSwap.
template <class T, bool kSwap>
T load(const char* p) {
  static_assert(sizeof(T) == 1 || sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8);
  if constexpr (!kSwap || sizeof(T) == 1) {
    T value;
    std::memcpy(&value, p, sizeof(T));
    return value;
  } else if constexpr (sizeof(T) == 2) {
    return std::bit_cast<T>(__builtin_bswap16(load<std::uint16_t, false>(p)));
  } else if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(__builtin_bswap32(load<std::uint32_t, false>(p)));
  } else {
    return std::bit_cast<T>(__builtin_bswap64(load<std::uint64_t, false>(p)));
  }
}

}  // namespace curvecast
