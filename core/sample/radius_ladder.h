// The radii that discs may have where they are sent one by one: rungs of a ladder of a quarter octave each, below a largest one.
// A disc that is rounded up to the next rung is a tenth too large on average, and its radius costs a fraction of a bit.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace curvecast {

class RadiusLadder {
 public:
  static constexpr int kRungs = 128, kRungsPerOctave = 4;  // the lowest is 2^-31.75 of the largest

  explicit RadiusLadder(double largest) {
    for (int k = 0; k < kRungs; ++k) {
      radius_[static_cast<std::size_t>(k)] = static_cast<float>(largest * std::exp2(-static_cast<double>(k) / kRungsPerOctave));
    }
  }

  /// Of rung 0, the largest, down to kRungs - 1.
  float radius(std::uint8_t rung) const { return radius_[rung]; }

  /// The lowest rung that is not below a radius; but for rounding, a rung's own radius gives that rung.
  std::uint8_t rung(float radius) const {
    const float ratio = radius_[0] / radius * kSlack;
    return below(ratio * ratio);
  }

  /// The lowest rung that is not below `largest / sqrt(square)`.
  static std::uint8_t below(float square) {
    if (!(square > 1)) return 0;
    // Two rungs for every power of two of the square: its exponent, and whether half of the next has been passed.
    const auto bits = std::bit_cast<std::uint32_t>(square);
    const int exponent = static_cast<int>(bits >> 23) - 127;
    const int rungs = 2 * exponent + ((bits & 0x7fffffu) >= kRootOfTwo ? 1 : 0);
    return static_cast<std::uint8_t>(rungs < kRungs ? rungs : kRungs - 1);
  }

 private:
  static constexpr float kSlack = 1.00001f;
  static constexpr std::uint32_t kRootOfTwo = 0x3504f3u;  // the fraction of its root as a float

  std::array<float, kRungs> radius_;
};

}  // namespace curvecast
