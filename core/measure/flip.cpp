#include "core/measure/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>

#include "core/base/vec.h"
#include "core/measure/pixel_plane.h"

namespace curvecast {
namespace {

using Planes = std::array<PixelPlane, 3>;
constexpr double kPi = std::numbers::pi;

// Section 4.1, and table 1: sums of Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
struct Gaussian {
  double a, b;
};
constexpr Gaussian kAchromatic = {1, 0.0047}, kRedGreen = {1, 0.0053}, kBlueYellow[] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double kWidestB = 0.04;
// Sections 4.1.2 and 4.2.
constexpr double kColourPower = 0.7, kLargeColour = 0.4, kLargeColourError = 0.95;
constexpr double kFeatureWidth = 0.082, kFeaturePower = 0.5;  // degrees

// Of D65, and of sRGB's primaries under it.
const Vec3d kWhite(0.950428545, 1, 1.088900371);
const Eigen::Matrix3d kXyzOfRgb = (Eigen::Matrix3d() << 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,  //
                                   2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,                         //
                                   1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382)
                                      .finished();
const Eigen::Matrix3d kRgbOfXyz = kXyzOfRgb.inverse();

double linear(std::uint8_t value) {
  const double s = value / 255.0;
  return s > 0.04045 ? std::pow((s + 0.055) / 1.055, 2.4) : s / 12.92;
}

/// The opponent space YCxCz.
Vec3d opponent(const Vec3d& rgb) {
  const Vec3d xyz = (kXyzOfRgb * rgb).cwiseQuotient(kWhite);
  return {116 * xyz.y() - 16, 500 * (xyz.x() - xyz.y()), 200 * (xyz.y() - xyz.z())};
}

Vec3d from_opponent(const Vec3d& ycc) {
  const double y = (ycc.x() + 16) / 116;
  return kRgbOfXyz * Vec3d(y + ycc.y() / 500, y, y - ycc.z() / 200).cwiseProduct(kWhite);
}

/// CIELAB with Hunt's adjustment: colours fade in the dark.
Vec3d adjusted_lab(const Vec3d& rgb) {
  const auto f = [](double t) {
    constexpr double kDelta = 6.0 / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  };
  const Vec3d xyz = (kXyzOfRgb * rgb).cwiseQuotient(kWhite);
  const double y = f(xyz.y()), lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (f(xyz.x()) - y), 0.01 * lightness * 200 * (y - f(xyz.z()))};
}

/// The HyAB distance.
double distance(const Vec3d& a, const Vec3d& b) { return std::abs(a.x() - b.x()) + (a - b).tail<2>().norm(); }

Planes opponent_of(const Image& image) {
  Planes planes = {PixelPlane(image.width, image.height), PixelPlane(image.width, image.height),
                   PixelPlane(image.width, image.height)};
  std::array<double, 256> linear_of;
  for (std::size_t i = 0; i < linear_of.size(); ++i) linear_of[i] = linear(static_cast<std::uint8_t>(i));
  for (std::size_t i = 0; i < planes[0].values.size(); ++i) {
    const std::uint8_t* const p = &image.rgba[4 * i];
    const Vec3d ycc = opponent({linear_of[p[0]], linear_of[p[1]], linear_of[p[2]]});
    for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].values[i] = static_cast<float>(ycc[c]);
  }
  return planes;
}

/// Filters a plane by a sum of Gaussians, cut off at a radius, whose weights add up to 1.
PixelPlane filtered(const PixelPlane& plane, std::span<const Gaussian> gaussians, double pixels_per_degree) {
  const auto radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidestB / (2 * kPi * kPi)) * pixels_per_degree));
  PixelPlane out(plane.width, plane.height);
  std::vector<double> share;
  double all = 0;
  for (const auto& [a, b] : gaussians) {
    double line = 0;
    for (int i = -radius; i <= radius; ++i) line += std::exp(-kPi * kPi * i * i / (pixels_per_degree * pixels_per_degree * b));
    all += share.emplace_back(a * std::sqrt(kPi / b) * line * line);
  }
  for (std::size_t g = 0; g < gaussians.size(); ++g) {
    const double deviation = std::sqrt(gaussians[g].b / 2) / kPi * pixels_per_degree;
    const std::vector<float> kernel = gaussian_kernel(radius, deviation);
    const PixelPlane part = convolve(plane, kernel, kernel);
    const auto weight = static_cast<float>(share[g] / all);
    for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] += weight * part.values[i];
  }
  return out;
}

/// What is left of a picture's colours at that distance.
std::vector<Vec3d> seen_colours(const Planes& picture, double pixels_per_degree) {
  const Planes blurred = {filtered(picture[0], {&kAchromatic, 1}, pixels_per_degree),
                          filtered(picture[1], {&kRedGreen, 1}, pixels_per_degree),
                          filtered(picture[2], kBlueYellow, pixels_per_degree)};
  std::vector<Vec3d> colours;
  colours.reserve(blurred[0].values.size());
  for (std::size_t i = 0; i < blurred[0].values.size(); ++i) {
    const Vec3d rgb = from_opponent({blurred[0].values[i], blurred[1].values[i], blurred[2].values[i]});
    colours.push_back(adjusted_lab(rgb.cwiseMax(0.0).cwiseMin(1.0)));
  }
  return colours;
}

/// The lengths of what a filter and the same one turned by a right angle see in a plane.
PixelPlane strength_of(const PixelPlane& plane, std::span<const float> filter, std::span<const float> smooth) {
  PixelPlane across = convolve(plane, filter, smooth);
  const PixelPlane down = convolve(plane, smooth, filter);
  for (std::size_t i = 0; i < across.values.size(); ++i) across.values[i] = std::hypot(across.values[i], down.values[i]);
  return across;
}

/// How much edges and points stand out: section 4.2.
std::array<PixelPlane, 2> features_of(PixelPlane lightness, double pixels_per_degree) {
  for (float& value : lightness.values) value = (value + 16) / 116;
  const double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
  const auto radius = static_cast<int>(std::ceil(3 * deviation));
  std::vector<float> edge, point;
  for (int i = -radius; i <= radius; ++i) {
    const double x = i / deviation, bell = std::exp(-0.5 * x * x);
    edge.push_back(static_cast<float>(-x * bell));
    point.push_back(static_cast<float>((x * x - 1) * bell));
  }
  for (std::vector<float>* const kernel : {&edge, &point}) {
    float below = 0, above = 0;
    for (const float value : *kernel) (value < 0 ? below : above) += std::abs(value);
    for (float& value : *kernel) value /= value < 0 ? below : above;
  }
  const std::vector<float> smooth = gaussian_kernel(radius, deviation);
  return {strength_of(lightness, edge, smooth), strength_of(lightness, point, smooth)};
}

/// The error of colours, 0 to 1, of their distance: section 4.1.2.
double colour_error(double distance_of_colours) {
  static const double most =
      std::pow(distance(adjusted_lab(Vec3d::UnitY()), adjusted_lab(Vec3d::UnitZ())), kColourPower);  // green and blue
  const double error = std::pow(distance_of_colours, kColourPower), large = kLargeColour * most;
  if (error < large) return kLargeColourError / large * error;
  return kLargeColourError + (error - large) / (most - large) * (1 - kLargeColourError);
}

}  // namespace

FlipError flip_error(const Image& reference, const Image& test, double pixels_per_degree) {
  const Planes a = opponent_of(reference), b = opponent_of(test);
  const std::vector<Vec3d> colours_a = seen_colours(a, pixels_per_degree), colours_b = seen_colours(b, pixels_per_degree);
  const auto features_a = features_of(a[0], pixels_per_degree), features_b = features_of(b[0], pixels_per_degree);
  FlipError out;
  double sum = 0;
  for (std::size_t i = 0; i < colours_a.size(); ++i) {
    double feature = 0;
    for (std::size_t f = 0; f < 2; ++f) {
      feature = std::max(feature, static_cast<double>(std::abs(features_a[f].values[i] - features_b[f].values[i])));
    }
    const double feature_error = std::min(std::pow(feature / std::numbers::sqrt2, kFeaturePower), 1.0);
    const double error = std::pow(colour_error(distance(colours_a[i], colours_b[i])), 1 - feature_error);
    out.error.push_back(static_cast<float>(error));
    sum += error;
  }
  out.mean = sum / static_cast<double>(colours_a.size());
  return out;
}

}  // namespace curvecast
