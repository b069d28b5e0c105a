// From linear light to sRGB.
#pragma once

#include <cstdint>

namespace curvecast {

/// 0 .. 1 as a byte; what lies beyond, or is no number, as the nearest end (NaN: 0). By a table of 16 bits.
std::uint8_t srgb_byte(double linear);

}  // namespace curvecast
