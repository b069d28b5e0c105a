// Random numbers from a seed and a counter: no state, so any of them can be had in any order, on any machine.
// Source: the finaliser of Steele, Lea, Flood, "Fast splittable pseudorandom number generators" (2014).
#pragma once

#include <cstdint>

namespace curvecast {

constexpr std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

inline constexpr std::uint64_t kRandomStep = 0x9e3779b97f4a7c15u;  // from one counter to the next

/// What mix_bits makes a seed's random numbers from, for the counter 0.
constexpr std::uint64_t random_start(std::uint64_t seed) { return mix_bits(seed + kRandomStep) + kRandomStep; }

/// Uniform in [0, 1).
constexpr double random_unit(std::uint64_t seed, std::uint64_t counter) {
  const std::uint64_t bits = mix_bits(random_start(seed) + counter * kRandomStep);
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace curvecast
