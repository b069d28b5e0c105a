// Several numbers at a time, for loops that the compiler does not turn into vector code by itself. Comparisons give masks;
// `mask ? a : b` selects number by number, without a jump. Values must not cross a function's interface: the ABI differs between
// instruction sets.
#pragma once

#include <cstdint>
#include <cstring>

namespace curvecast {

using Double4 = double __attribute__((vector_size(32)));
using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));   // what comparing Float8 gives: -1 or 0
using Int4 = std::int32_t __attribute__((vector_size(16)));   // also what comparing Float4 and Int4 gives: -1 or 0
using Mask4 = std::int64_t __attribute__((vector_size(32)));  // what comparing Double4 gives: -1 or 0

/// Copy values from and to memory of any alignment. Always inlined, and so without an interface.
template <typename Vector, typename T>
[[gnu::always_inline]] inline void load_lanes(Vector& to, const T* from) {
  std::memcpy(&to, from, sizeof(Vector));
}
template <typename Vector, typename T>
[[gnu::always_inline]] inline void store_lanes(const Vector& from, T* to) {
  std::memcpy(to, &from, sizeof(Vector));
}

/// Minimum and maximum by value: one instruction each, where std::min and std::max, which take references, become
/// jumps that cannot be predicted. NaN: the second argument.
[[gnu::always_inline]] constexpr double fast_min(double a, double b) { return a < b ? a : b; }
[[gnu::always_inline]] constexpr double fast_max(double a, double b) { return a > b ? a : b; }
[[gnu::always_inline]] constexpr float fast_min(float a, float b) { return a < b ? a : b; }
[[gnu::always_inline]] constexpr float fast_max(float a, float b) { return a > b ? a : b; }
[[gnu::always_inline]] constexpr double fast_clamp(double x, double low, double high) { return fast_min(fast_max(x, low), high); }

// Compiles a function for wider vectors too; which one runs is decided when the program starts. The results are the same to the
// bit, because nothing is contracted. (Sanitised programs are not ready for that decision so early.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CURVECAST_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define CURVECAST_WIDE
#endif

}  // namespace curvecast
