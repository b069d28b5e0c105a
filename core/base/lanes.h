// Four numbers at a time, for loops that the compiler does not turn into vector code by itself. Comparisons give
// masks, `mask ? a : b` selects lane by lane, without a jump. Values must not cross a function's interface: the ABI differs
// between instruction sets.
#pragma once

#include <cstdint>
#include <cstring>

namespace curvecast {

using Lanes = double __attribute__((vector_size(32)));
using LaneMask = std::int64_t __attribute__((vector_size(32)));  // -1 or 0
using FloatLanes = float __attribute__((vector_size(16)));

/// Wherever the values lie; always inlined, and so without an interface.
template <typename Vector, typename T>
[[gnu::always_inline]] inline void load_lanes(Vector& to, const T* from) {
  std::memcpy(&to, from, sizeof(Vector));
}
template <typename Vector, typename T>
[[gnu::always_inline]] inline void store_lanes(const Vector& from, T* to) {
  std::memcpy(to, &from, sizeof(Vector));
}

// Compiles a function for wider vectors too; which one runs is decided when the program starts. The results are the same to the
// bit, because nothing is contracted. (Sanitised programs are not ready for that decision so early.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CURVECAST_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define CURVECAST_WIDE
#endif

}  // namespace curvecast
