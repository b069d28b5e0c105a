// One-dimensional sequences that place samples along the curve (paper, section 3.4).
// Sources: Niederreiter, "Random Number Generation and Quasi-Monte Carlo Methods" (1992), chapter 3; for the order of multiples
// of the golden ratio, Sos, "On the distribution mod 1 of the sequence n alpha" (1958).
#pragma once

#include <cstdint>
#include <span>

namespace curvecast {

enum class Sequence {
  kJittered,  // (i + 1/2 + u) / N, u uniform in [-1/2, 1/2)
  kRegular,   // (i + 1/2) / N
  // The first N of an endless sequence, all moved by the seed's u and wrapped round: more points add to fewer.
  kVanDerCorput,  // the bits of i mirrored at the binary point
  kGoldenRatio,   // i (sqrt(5) - 1) / 2 modulo 1
};

/// Fills `q` with N = q.size() ascending numbers in [0, 1). The same seed gives the same numbers on every machine.
/// Precondition: N < 2^31.
void fill_sequence(Sequence sequence, std::uint64_t seed, std::span<double> q);

}  // namespace curvecast
