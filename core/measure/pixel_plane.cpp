#include "core/measure/pixel_plane.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace curvecast {

std::vector<float> gaussian_kernel(int radius, double deviation) {
  std::vector<double> bell;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += bell.emplace_back(std::exp(-0.5 * i * i / (deviation * deviation)));
  std::vector<float> kernel;
  for (const double value : bell) kernel.push_back(static_cast<float>(value / sum));
  return kernel;
}

PixelPlane convolve(const PixelPlane& plane, std::span<const float> across, std::span<const float> down) {
  const int width = plane.width, height = plane.height;
  const auto reach_x = static_cast<int>(across.size() / 2), reach_y = static_cast<int>(down.size() / 2);
  PixelPlane rows(width, height), out(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    std::vector<float> wide(static_cast<std::size_t>(width + 2 * reach_x));
    for (int x = -reach_x; x < width + reach_x; ++x) {
      wide[static_cast<std::size_t>(x + reach_x)] = plane.row(y)[std::clamp(x, 0, width - 1)];
    }
    float* const to = rows.row(y);
    for (std::size_t k = 0; k < across.size(); ++k) {
      const float weight = across[across.size() - 1 - k];
      const float* const from = wide.data() + k;
      for (int x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  });
  tbb::parallel_for(0, height, [&](int y) {
    float* const to = out.row(y);
    for (int k = -reach_y; k <= reach_y; ++k) {
      const float weight = down[static_cast<std::size_t>(reach_y - k)];
      const float* const from = rows.row(std::clamp(y + k, 0, height - 1));
      for (int x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  });
  return out;
}

}  // namespace curvecast
