// A picture in memory.
#pragma once

#include <cstdint>
#include <vector>

namespace curvecast {

struct Image {
  int width = 0, height = 0;       // pixels
  std::vector<std::uint8_t> rgba;  // 4 * width * height, sRGB with straight alpha, rows from top to bottom
};

}  // namespace curvecast
