// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/symbol_values.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace curvecast::client {
namespace {

// Four components at a time: the compiler makes no vectors of them by itself.
using Unsigned4 = std::uint32_t __attribute__((vector_size(16)));
using Signed4 = std::int32_t __attribute__((vector_size(16)));
using Float4 = float __attribute__((vector_size(16)));

Signed4 all(std::int32_t value) { return Signed4{value, value, value, value}; }

}  // namespace

WrappedValues::WrappedValues(std::int32_t min, std::int32_t max) : min_(min), max_(max) {
  previous_.fill(std::clamp(0, min, max));
}

template <std::size_t kComponents, typename Store>
void WrappedValues::sum(const std::uint32_t* symbols, std::size_t count, Store&& store) {
  const Signed4 min = all(min_), max = all(max_), size = all(max_ - min_ + 1);
  Signed4 value, outside = all(0);
  std::memcpy(&value, previous_.data(), sizeof value);
  for (std::size_t i = 0; i < count; ++i, symbols += kComponents) {
    Unsigned4 symbol;
    std::memcpy(&symbol, symbols, sizeof symbol);
    // The lowest bit is the sign: 0, -1, 1, -2, ...
    const Unsigned4 difference = (symbol >> 1) ^ -(symbol & 1);
    const Signed4 reached = (Signed4)((Unsigned4)value + difference);
    value = (Signed4)((Unsigned4)reached - (Unsigned4)((reached > max) & size) + (Unsigned4)((reached < min) & size));
    outside |= (value > max) | (value < min);
    store(i, value);
  }
  std::memcpy(previous_.data(), &value, sizeof value);
  for (std::size_t c = 0; c < kComponents; ++c) within_ = within_ && outside[c] == 0;
}

void WrappedValues::to_places(const std::uint32_t* symbols, float delta, const std::array<float, 3>& low,
                              std::span<std::array<float, 3>> places) {
  const Float4 base{low[0], low[1], low[2], 0};
  sum<3>(symbols, places.size(), [&](std::size_t i, const Signed4& number) {
    const Float4 place = __builtin_convertvector(number, Float4) * delta + base;
    std::memcpy(&places[i], &place, sizeof places[i]);
  });
}

void WrappedValues::to_radii(const std::uint32_t* symbols, const std::array<float, 256>& table, std::span<float> radii) {
  sum<1>(symbols, radii.size(),
         [&](std::size_t i, const Signed4& number) { radii[i] = table[static_cast<std::uint8_t>(number[0])]; });
}

void WrappedValues::to_colours(const std::uint32_t* symbols, std::size_t components,
                               std::span<std::array<std::uint8_t, 3>> colours) {
  const auto store = [&](std::size_t i, const Signed4& number) {
    for (int c = 0; c < 3; ++c) colours[i][c] = static_cast<std::uint8_t>(number[c]);
  };
  if (components == 3) {
    sum<3>(symbols, colours.size(), store);
  } else {
    sum<4>(symbols, colours.size(), store);
  }
}

OctahedralValues::OctahedralValues(int bits) : centre_((1 << (bits - 1)) - 1), previous_{-centre_, -centre_} {}

namespace {

/// Exchanges the inside of the diamond |s| + |t| <= centre, the front half of the octahedron, with the corners around it.
void turn_inside_out(std::int32_t centre, std::int32_t& s, std::int32_t& t) {
  if ((s >= 0 && t >= 0) || (s <= 0 && t <= 0)) {
    const std::int32_t corner = s >= 0 && t >= 0 ? centre : -centre;
    s = std::exchange(t, corner - s);
    s = corner - s;
  } else {
    const std::int32_t corner = s > 0 ? centre : -centre;
    s = std::exchange(t, s - corner);
    s += corner;
  }
}

/// Differences are stored as if the point before lay in the quadrant s < 0, t <= 0: turns one back to where (s, t) lies.
void turn_back(std::int32_t s, std::int32_t t, std::int32_t& ds, std::int32_t& dt) {
  if (s >= 0 && t < 0) {
    ds = std::exchange(dt, ds);
    ds = -ds;
  } else if (s > 0) {
    ds = -ds;
    dt = -dt;
  } else if (t > 0) {
    dt = std::exchange(ds, dt);
    dt = -dt;
  }
}

}  // namespace

void OctahedralValues::to_cells(const std::uint32_t* symbols, std::span<std::array<std::int32_t, 2>> cells) {
  const std::int32_t centre = centre_, size = 2 * centre_ + 1;
  const auto wrap = [&](std::int32_t x) { return x > centre ? x - size : x < -centre ? x + size : x; };
  auto [s, t] = previous_;
  for (std::array<std::int32_t, 2>& cell : cells) {
    auto ds = static_cast<std::int32_t>(*symbols++), dt = static_cast<std::int32_t>(*symbols++);
    // Neighbours mostly lie on the same side: jumps that are foreseen cost less than a longer chain of selections.
    const bool in_corner = std::abs(s) + std::abs(t) > centre;
    if (in_corner) turn_inside_out(centre, s, t);
    turn_back(s, t, ds, dt);
    s = wrap(s + ds);
    t = wrap(t + dt);
    if (in_corner) turn_inside_out(centre, s, t);
    cell = {s + centre, t + centre};
  }
  previous_ = {s, t};
}

void OctahedralValues::to_normals(const std::uint32_t* symbols, std::span<std::array<float, 3>> normals) {
  constexpr std::size_t kPart = 256;
  std::array<std::array<std::int32_t, 2>, kPart> cells;
  std::array<std::array<float, kPart>, 3> axes;
  const float scale = 2.0F / static_cast<float>(2 * centre_);
  for (std::size_t begin = 0; begin < normals.size(); begin += kPart) {
    const std::size_t count = std::min(kPart, normals.size() - begin);
    std::uint32_t largest = 0;
    for (std::size_t i = 0; i < 2 * count; ++i) largest = std::max(largest, symbols[2 * begin + i]);
    within_ = within_ && largest <= static_cast<std::uint32_t>(2 * centre_);
    if (!within_) return;
    to_cells(symbols + 2 * begin, std::span(cells).first(count));
    auto& [x, y, z] = axes;
    for (std::size_t i = 0; i < count; ++i) {
      const float unfolded_y = static_cast<float>(cells[i][0]) * scale - 1.0F;
      const float unfolded_z = static_cast<float>(cells[i][1]) * scale - 1.0F;
      x[i] = 1.0F - std::abs(unfolded_y) - std::abs(unfolded_z);
      const float beyond = x[i] < 0 ? -x[i] : 0.0F;
      y[i] = unfolded_y + (unfolded_y < 0 ? beyond : -beyond);
      z[i] = unfolded_z + (unfolded_z < 0 ? beyond : -beyond);
      const float to_unit = 1.0F / std::sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);  // of 1/3 at least
      x[i] *= to_unit;
      y[i] *= to_unit;
      z[i] *= to_unit;
    }
    for (std::size_t i = 0; i < count; ++i) normals[begin + i] = {x[i], y[i], z[i]};
  }
}

}  // namespace curvecast::client
