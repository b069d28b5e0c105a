// One-dimensional sequences that place samples along the curve (paper, section 3.4).
#pragma once

#include <cstdint>
#include <span>

namespace curvecast {

enum class Sequence {
  kJittered,  // (i + 1/2 + u) / N, u uniform in [-1/2, 1/2)
  kRegular,   // (i + 1/2) / N
};

/// Fills `q` with N = q.size() ascending numbers in [0, 1). The same seed gives the same numbers on every machine.
void fill_sequence(Sequence sequence, std::uint64_t seed, std::span<double> q);

}  // namespace curvecast
