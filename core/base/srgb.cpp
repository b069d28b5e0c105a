#include "core/base/srgb.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/colour.h"

namespace curvecast {

std::uint8_t srgb_byte(double linear) {
  constexpr double kLast = 65'535;
  static const std::vector<std::uint8_t> kTable = [] {
    std::vector<std::uint8_t> bytes;
    for (double i = 0; i <= kLast; ++i) {
      const double x = i / kLast;
      bytes.push_back(unit_to_byte(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055));
    }
    return bytes;
  }();
  return kTable[linear > 0 ? static_cast<std::size_t>(std::min(linear, 1.0) * kLast + 0.5) : 0];
}

}  // namespace curvecast
