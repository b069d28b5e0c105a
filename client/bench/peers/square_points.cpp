#include "client/bench/peers/square_points.h"

#include <cstdint>

#include "core/base/reversed_bits.h"

namespace curvecast::cli::bench {
namespace {

constexpr int kBits = 32;
constexpr double kUnit = 0x1p-32;

double van_der_corput(std::uint64_t i) { return kUnit * static_cast<double>(reversed_bits(i, kBits)); }

/// The second coordinate: the digits of i times Pascal's triangle modulo 2, of which each column follows from the one before.
double pascal(std::uint64_t i) {
  std::uint32_t column = std::uint32_t{1} << (kBits - 1), sum = 0;
  for (; i != 0; i >>= 1) {
    if ((i & 1) != 0) sum ^= column;
    column ^= column >> 1;
  }
  return kUnit * sum;
}

}  // namespace

std::vector<Vec2d> niederreiter_points(std::size_t n) {
  std::vector<Vec2d> points;
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) points.emplace_back(van_der_corput(i), pascal(i));
  return points;
}

std::vector<Vec2d> hammersley_points(std::size_t n) {
  std::vector<Vec2d> points;
  points.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(static_cast<double>(i) / static_cast<double>(n), van_der_corput(i));
  }
  return points;
}

}  // namespace curvecast::cli::bench
