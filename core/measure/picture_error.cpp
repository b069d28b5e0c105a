#include "core/measure/picture_error.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "core/measure/pixel_plane.h"

namespace curvecast {
namespace {

constexpr int kWindowRadius = 5;  // pixels
constexpr double kWindowDeviation = 1.5;
constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;

PixelPlane lightness_of(const Image& image) {
  PixelPlane plane(image.width, image.height);
  for (std::size_t i = 0; i < plane.values.size(); ++i) {
    const std::uint8_t* const p = &image.rgba[4 * i];
    plane.values[i] = 0.299f * static_cast<float>(p[0]) + 0.587f * static_cast<float>(p[1]) + 0.114f * static_cast<float>(p[2]);
  }
  return plane;
}

PixelPlane product(const PixelPlane& a, const PixelPlane& b) {
  PixelPlane out(a.width, a.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = a.values[i] * b.values[i];
  return out;
}

}  // namespace

double psnr(const Image& reference, const Image& test) {
  double squares = 0;
  const std::size_t pixels = reference.rgba.size() / 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = static_cast<double>(reference.rgba[4 * i + c]) - static_cast<double>(test.rgba[4 * i + c]);
      squares += difference * difference;
    }
  }
  if (squares == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(pixels) / squares);
}

double ssim(const Image& reference, const Image& test) {
  const std::vector<float> window = gaussian_kernel(kWindowRadius, kWindowDeviation);
  const auto mean_of = [&](const PixelPlane& plane) { return convolve(plane, window, window); };
  const PixelPlane a = lightness_of(reference), b = lightness_of(test);
  const PixelPlane mean_a = mean_of(a), mean_b = mean_of(b);
  const PixelPlane aa = mean_of(product(a, a)), bb = mean_of(product(b, b)), ab = mean_of(product(a, b));
  double sum = 0;
  for (int y = kWindowRadius; y < a.height - kWindowRadius; ++y) {
    for (int x = kWindowRadius; x < a.width - kWindowRadius; ++x) {
      const double ma = mean_a.row(y)[x], mb = mean_b.row(y)[x];
      const double va = aa.row(y)[x] - ma * ma, vb = bb.row(y)[x] - mb * mb, cov = ab.row(y)[x] - ma * mb;
      sum += (2 * ma * mb + kC1) * (2 * cov + kC2) / ((ma * ma + mb * mb + kC1) * (va + vb + kC2));
    }
  }
  return sum / (static_cast<double>(a.height - 2 * kWindowRadius) * (a.width - 2 * kWindowRadius));
}

}  // namespace curvecast
