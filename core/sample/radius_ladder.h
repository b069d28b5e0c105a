// The radii that discs may have where radii are sent: rungs of half an octave each, below a largest radius. Radii are rounded up
// to the next rung. That makes discs a fifth too large on average; but a radius then takes a fraction of a bit, and few discs
// change from one view to the next.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace curvecast {

class RadiusLadder {
 public:
  static constexpr int kRungs = 64, kRungsPerOctave = 2;  // the lowest is 2^-31.5 of the largest

  explicit RadiusLadder(double largest) {
    for (int k = 0; k < kRungs; ++k) {
      radius_[static_cast<std::size_t>(k)] = static_cast<float>(largest * std::exp2(-static_cast<double>(k) / kRungsPerOctave));
    }
  }

  /// Returns the radius of a rung: the largest for rung 0, the smallest for kRungs - 1.
  float radius(std::uint8_t rung) const { return radius_[rung]; }

  /// Returns the rung with the smallest radius that is at least this one. The radius of a rung gives that rung.
  std::uint8_t rung(float radius) const {
    const float ratio = radius_[0] / radius * kSlack;
    return below(ratio * ratio);
  }

  /// Returns the rung with the smallest radius that is at least largest / sqrt(square).
  static std::uint8_t below(float square) {
    if (!(square > 1)) return 0;
    // A rung for every power of two of the square: its exponent.
    const int rungs = static_cast<int>(std::bit_cast<std::uint32_t>(square) >> 23) - 127;
    return static_cast<std::uint8_t>(rungs < kRungs ? rungs : kRungs - 1);
  }

 private:
  static constexpr float kSlack = 1.00001f;

  std::array<float, kRungs> radius_;
};

}  // namespace curvecast
