#include "core/mesh_io/text_colours.h"

#include <algorithm>

#include "core/mesh_io/reading/mesh_reading.h"

namespace curvecast {
namespace {

constexpr float kNothing = -1;

}  // namespace

void TextColours::put(std::size_t i, const std::array<float, 4>& rgba) {
  values_.resize(i, {kNothing, kNothing, kNothing, kNothing});
  values_.push_back(rgba);
  for (const float value : rgba) largest_ = std::max(largest_, value);
}

std::vector<Rgba8> TextColours::take(std::size_t count) {
  std::vector<Rgba8> colours;
  if (empty()) return colours;
  colours.resize(count);
  const double scale = largest_ > 1 ? 1.0 / 255 : 1;
  const auto byte = [&](float value) { return unit_to_byte(scale * value); };
  for (std::size_t i = 0; i < std::min(count, values_.size()); ++i) {
    const std::array<float, 4>& v = values_[i];
    if (v == std::array{kNothing, kNothing, kNothing, kNothing}) continue;
    colours[i] = {byte(v[0]), byte(v[1]), byte(v[2]), v[3] < 0 ? std::uint8_t{255} : byte(v[3])};
  }
  return colours;
}

}  // namespace curvecast
