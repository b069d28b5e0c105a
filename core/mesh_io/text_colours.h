// Colours as text formats write them, before it is known whether they go to 1 or to 255.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/colour.h"

namespace curvecast {

class TextColours {
 public:
  /// The colour of element i; alpha below 0: none, which is opaque. Elements that get none are white.
  void put(std::size_t i, const std::array<float, 4>& rgba);
  bool empty() const { return values_.empty(); }
  /// Returns the colours of all `count` elements: 0 .. 1 is the whole range unless one value is larger, then 0 .. 255. Empty when
  /// none was put.
  std::vector<Rgba8> take(std::size_t count);

 private:
  std::vector<std::array<float, 4>> values_;
  float largest_ = 0;
};

}  // namespace curvecast
