// Small pictures, to be compared.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/image.h"

namespace curvecast::testing {

/// Calls colour(x, y, channel) for a picture of 64 x 48 pixels; what it returns is cut off at 0 and 255.
template <typename Colour>
Image picture_of(const Colour& colour) {
  Image image{64, 48, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) image.rgba.push_back(static_cast<std::uint8_t>(std::clamp(colour(x, y, c), 0, 255)));
      image.rgba.push_back(255);
    }
  }
  return image;
}

/// A disc on a gradient, both coloured.
inline int scene_colour(int x, int y, int channel, int shift = 0) {
  const bool in_disc = (x - 20 - shift) * (x - 20 - shift) + (y - 24) * (y - 24) < 150;
  const int disc[] = {200, 60 + 3 * y, 40}, ground[] = {30 + 2 * x, 90 + y, 255 - 3 * x};
  return std::clamp(in_disc ? disc[channel] : ground[channel], 0, 255);
}

/// The disc has moved to the right.
inline Image scene_picture(int shift = 0) {
  return picture_of([&](int x, int y, int c) { return scene_colour(x, y, c, shift); });
}
inline Image noisy_picture() {
  return picture_of([](int x, int y, int c) { return scene_colour(x, y, c) + ((x * 7 + y * 13) % 5 - 2) * 6; });
}
inline Image dark_picture() {
  return picture_of([](int x, int y, int c) { return scene_colour(x, y, c) / 2; });
}

}  // namespace curvecast::testing
