// A colour as files and screens hold it.
#pragma once

#include <cmath>
#include <cstdint>

namespace curvecast {

/// sRGB-encoded, alpha not premultiplied, each 0 .. 255.
struct Rgba8 {
  std::uint8_t r = 255, g = 255, b = 255, a = 255;

  bool operator==(const Rgba8&) const = default;
};

/// Maps 0 .. 1 to 0 .. 255, rounded. Values beyond become the nearest end, NaN becomes 0.
inline std::uint8_t unit_to_byte(double value) {
  return value > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::fmin(value, 1))) : std::uint8_t{0};
}

}  // namespace curvecast
