// A colour as files and screens hold it.
#pragma once

#include <cstdint>

namespace curvecast {

/// sRGB-encoded, alpha not premultiplied, each 0 .. 255.
struct Rgba8 {
  std::uint8_t r = 255, g = 255, b = 255, a = 255;

  bool operator==(const Rgba8&) const = default;
};

}  // namespace curvecast
