#include "core/codec/lattice.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

// Four points are twelve numbers, and so three times four lanes, in which x, y and z take turns.
constexpr std::size_t kPoints = 4, kNumbers = 3 * kPoints, kParts = 3;

constexpr Int4 kAll = {-1, -1, -1, -1};

[[gnu::always_inline]] inline bool are_all(const Int4& mask) { return (mask[0] & mask[1] & mask[2] & mask[3]) != 0; }

struct Bounds {
  std::array<float, kNumbers> low, high, zero;
  float slack, steps;  // steps per unit of length
};

float steps_of(const Lattice& lattice) { return static_cast<float>((1 << lattice.bits) - 1) / lattice.size; }

Bounds bounds_of(const Lattice& lattice) {
  Bounds bounds{.slack = 1e-3f * lattice.size, .steps = steps_of(lattice)};
  for (std::size_t i = 0; i < kNumbers; ++i) {
    bounds.low[i] = lattice.low[static_cast<int>(i % 3)];
    bounds.high[i] = bounds.low[i] + lattice.size;
    bounds.zero[i] = lattice.is_centred ? 0 : bounds.low[i];
  }
  return bounds;
}

/// Of four points; clears lanes of the mask where one lies outside.
[[gnu::always_inline]] inline void round_four(const float* numbers, const Bounds& bounds, std::int32_t* coordinates,
                                              Int4& are_inside) {
  // Reached where floats are coarser than the box.
  const Float4 most = Float4{} + static_cast<float>(1 << 30);
  for (std::size_t part = 0; part < kParts; ++part) {
    Float4 x, low, high, zero;
    load_lanes(x, numbers + 4 * part);
    load_lanes(low, &bounds.low[4 * part]);
    load_lanes(high, &bounds.high[4 * part]);
    load_lanes(zero, &bounds.zero[4 * part]);
    Float4 nearest = x > low ? x : low;
    nearest = nearest < high ? nearest : high;
    are_inside &= (x - nearest <= bounds.slack) & (nearest - x <= bounds.slack);
    // Conversion rounds towards 0.
    const Float4 steps = (nearest - zero) * bounds.steps;
    Float4 rounded = steps < 0.0f ? steps - 0.5f : steps + 0.5f;
    rounded = rounded < most ? rounded : most;
    rounded = rounded > -most ? rounded : -most;
    store_lanes(__builtin_convertvector(rounded, Int4), coordinates + 4 * part);
  }
}

/// As round_four(), of a few.
bool round_some(std::span<const Vec3f> positions, const Bounds& bounds, std::int32_t* coordinates) {
  std::array<float, kNumbers> numbers = bounds.low;
  std::array<std::int32_t, kNumbers> rounded;
  for (std::size_t i = 0; i < positions.size(); ++i) std::copy_n(positions[i].data(), 3, &numbers[3 * i]);
  Int4 are_inside = kAll;
  round_four(numbers.data(), bounds, rounded.data(), are_inside);
  std::copy_n(rounded.data(), 3 * positions.size(), coordinates);
  return are_all(are_inside);
}

absl::Status refusal(std::size_t i, const Vec3f& p) {
  return absl::InvalidArgumentError(
      absl::StrFormat("point %d (%g, %g, %g) lies outside of the lattice's box", i, p.x(), p.y(), p.z()));
}

}  // namespace

absl::Status check_lattice(const Lattice& lattice) {
  if (lattice.low.allFinite() && lattice.size > 0 && std::isfinite(lattice.size) && std::isfinite(steps_of(lattice))) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError("the lattice's box must be finite and larger than nothing, as floats");
}

absl::Status to_lattice(const Lattice& lattice, std::span<const Vec3f> positions, std::span<std::int32_t> coordinates) {
  const Bounds bounds = bounds_of(lattice);
  const std::size_t n = positions.size(), whole = n - n % kPoints;
  Int4 are_inside = kAll;
  for (std::size_t i = 0; i < whole; i += kPoints) round_four(positions[i].data(), bounds, &coordinates[3 * i], are_inside);
  const bool is_rest_inside = round_some(positions.subspan(whole), bounds, coordinates.data() + 3 * whole);
  if (is_rest_inside && are_all(are_inside)) return absl::OkStatus();
  // Once more, point by point, for the message.
  std::size_t outside = 0;
  while (round_some(positions.subspan(outside, 1), bounds, &coordinates[3 * outside])) ++outside;
  return refusal(outside, positions[outside]);
}

}  // namespace curvecast
