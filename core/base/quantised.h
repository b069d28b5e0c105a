// Small number formats for values of which millions are kept and few digits matter. They convert to and from float by themselves.
// What is no number becomes the least that there is, unless a format is not for it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace curvecast {

/// [-1, 1] in steps of 1 / 32767: components of unit vectors, to two thousandths of a degree.
struct Snorm16 {
  std::int16_t code = 0;

  Snorm16() = default;
  constexpr Snorm16(float value) {
    // A float this large has steps of one: adding it rounds.
    constexpr float kRound = 12582912.0f;
    const float rounded = std::min(std::max(-1.0f, value), 1.0f) * 32767.0f + kRound;
    code = static_cast<std::int16_t>(std::bit_cast<std::int32_t>(rounded) - std::bit_cast<std::int32_t>(kRound));
  }
  constexpr operator float() const { return static_cast<float>(code) * (1 / 32767.0f); }
};

/// [0, 1] in steps of 1 / 65535.
struct Unorm16 {
  std::uint16_t code = 0;

  Unorm16() = default;
  constexpr Unorm16(float value) : code(static_cast<std::uint16_t>(std::min(std::max(0.0f, value), 1.0f) * 65535.0f + 0.5f)) {}
  constexpr operator float() const { return static_cast<float>(code) * (1 / 65535.0f); }
};

/// A unit vector to half a degree, or none. Its components, in parts of kOne, are bytes of one number: compilers make vector code
/// of loops over such, not over structures of bytes.
struct Direction8 {
  static constexpr float kOne = 127;

  std::uint32_t code = 0;

  Direction8() = default;
  /// Of any three components in [-1, 1]; zeros stand for none.
  template <typename Vector>
  explicit Direction8(const Vector& v) : code(byte_of(v[0]) | byte_of(v[1]) << 8 | byte_of(v[2]) << 16) {}
  bool operator==(const Direction8&) const = default;
  bool is_none() const { return code == 0; }
  [[gnu::always_inline]] float x() const { return value_of(code); }
  [[gnu::always_inline]] float y() const { return value_of(code >> 8); }
  [[gnu::always_inline]] float z() const { return value_of(code >> 16); }
  template <typename Vector>
  Vector unpacked() const {
    return Vector(x(), y(), z()) * (1 / kOne);
  }

 private:
  static std::uint32_t byte_of(float value) {
    return static_cast<std::uint8_t>(std::lround(kOne * std::min(std::max(-1.0f, value), 1.0f)));
  }
  [[gnu::always_inline]] static float value_of(std::uint32_t number) {
    return static_cast<float>(static_cast<std::int32_t>(number << 24) >> 24);
  }
};

/// The upper half of a float, rounded to nearest: its whole range with 8 significant bits, within 0.2 %. Not for NaN.
struct Bfloat16 {
  std::uint16_t code = 0;

  Bfloat16() = default;
  constexpr Bfloat16(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(std::clamp(value, -kLargest, kLargest));
    code = static_cast<std::uint16_t>((bits + 0x7fff + (bits >> 16 & 1)) >> 16);
  }
  constexpr operator float() const { return std::bit_cast<float>(static_cast<std::uint32_t>(code) << 16); }

 private:
  static constexpr float kLargest = std::bit_cast<float>(0x7f7f0000u);
};

}  // namespace curvecast
