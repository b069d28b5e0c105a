#include "core/codec/lattice.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/lanes.h"

namespace curvecast {
namespace {

using IntLanes = std::int32_t __attribute__((vector_size(16)));

// Four points are twelve numbers, and so three times four lanes, in which x, y and z take turns.
constexpr std::size_t kPoints = 4, kNumbers = 3 * kPoints, kParts = 3;

struct Bounds {
  std::array<float, kNumbers> low, high;
  float slack, steps;  // steps per unit of length
};

float steps_of(const Lattice& lattice) { return static_cast<float>((1 << lattice.bits) - 1) / lattice.size; }

Bounds bounds_of(const Lattice& lattice) {
  Bounds bounds{.slack = 1e-3f * lattice.size, .steps = steps_of(lattice)};
  for (std::size_t i = 0; i < kNumbers; ++i) {
    bounds.low[i] = lattice.low[static_cast<int>(i % 3)];
    bounds.high[i] = bounds.low[i] + lattice.size;
  }
  return bounds;
}

/// Of four points; false where one lies outside.
[[gnu::always_inline]] inline bool round_four(const float* numbers, const Bounds& bounds, std::int32_t* coordinates) {
  constexpr float kMost = 1 << 30;  // reached where rounding makes the box larger than it is
  IntLanes is_inside = {-1, -1, -1, -1};
  for (std::size_t part = 0; part < kParts; ++part) {
    FloatLanes x, low, high;
    load_lanes(x, numbers + 4 * part);
    load_lanes(low, &bounds.low[4 * part]);
    load_lanes(high, &bounds.high[4 * part]);
    FloatLanes nearest = x > low ? x : low;
    nearest = nearest < high ? nearest : high;
    is_inside &= (x - nearest <= bounds.slack) & (nearest - x <= bounds.slack);
    FloatLanes rounded = (nearest - low) * bounds.steps + 0.5f;
    rounded = rounded < kMost ? rounded : FloatLanes{} + kMost;
    store_lanes(__builtin_convertvector(rounded, IntLanes), coordinates + 4 * part);
  }
  return (is_inside[0] & is_inside[1] & is_inside[2] & is_inside[3]) != 0;
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
  const std::size_t n = positions.size();
  // A block that lies outside in part is gone through again, point by point, for the message.
  const auto find_outside = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin;; ++i) {
      std::array<float, kNumbers> four = bounds.low;
      std::array<std::int32_t, kNumbers> ignored;
      std::copy_n(positions[i].data(), 3, four.data());
      if (i + 1 == end || !round_four(four.data(), bounds, ignored.data())) return refusal(i, positions[i]);
    }
  };
  std::size_t i = 0;
  for (; i + kPoints <= n; i += kPoints) {
    if (!round_four(positions[i].data(), bounds, &coordinates[3 * i])) return find_outside(i, i + kPoints);
  }
  if (i == n) return absl::OkStatus();
  std::array<float, kNumbers> rest = bounds.low;
  std::array<std::int32_t, kNumbers> rounded;
  for (std::size_t j = i; j < n; ++j) std::copy_n(positions[j].data(), 3, &rest[3 * (j - i)]);
  if (!round_four(rest.data(), bounds, rounded.data())) return find_outside(i, n);
  std::copy_n(rounded.data(), 3 * (n - i), &coordinates[3 * i]);
  return absl::OkStatus();
}

}  // namespace curvecast
