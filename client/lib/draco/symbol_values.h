// SPDX-License-Identifier: Apache-2.0
// Turns the symbols of a Draco attribute into its values: each is a difference to the point before, on a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace curvecast::client {

/// Whole numbers, all between two bounds; a sum that leaves them re-enters on the other side. Up to four components.
class WrappedValues {
 public:
  static constexpr std::size_t kPadding = 3;  // symbols behind the last that must be readable

  /// max - min must be below 2^31 - 1, and not negative.
  WrappedValues(std::int32_t min, std::int32_t max);

  /// All take the symbols of the next points, component by component: value = low + delta * number for places, table[number] for
  /// radii (of the number's lowest byte), the lowest bytes of the first three of `components` for colours.
  void to_places(const std::uint32_t* symbols, float delta, const std::array<float, 3>& low,
                 std::span<std::array<float, 3>> places);
  void to_radii(const std::uint32_t* symbols, const std::array<float, 256>& table, std::span<float> radii);
  void to_colours(const std::uint32_t* symbols, std::size_t components, std::span<std::array<std::uint8_t, 3>> colours);

  /// False once a number has left the bounds: no encoder writes that.
  bool all_within() const { return within_; }

 private:
  template <std::size_t kComponents, typename Store>
  void sum(const std::uint32_t* symbols, std::size_t count, Store&& store);

  std::int32_t min_, max_;
  std::array<std::int32_t, 4> previous_;
  bool within_ = true;
};

/// Unit vectors on an octahedron that is unfolded to a square of (2 centre + 1)^2 cells, centre = 2^(bits - 1) - 1.
class OctahedralValues {
 public:
  /// 2 .. 30 bits.
  explicit OctahedralValues(int bits);

  /// Takes the symbols of the next normals, two for each.
  void to_normals(const std::uint32_t* symbols, std::span<std::array<float, 3>> normals);

  /// False once a symbol was outside of the square: no encoder writes that.
  bool all_within() const { return within_; }

 private:
  void to_cells(const std::uint32_t* symbols, std::span<std::array<std::int32_t, 2>> cells);

  std::int32_t centre_;
  std::array<std::int32_t, 2> previous_;  // from the centre
  bool within_ = true;
};

}  // namespace curvecast::client
