// SPDX-License-Identifier: Apache-2.0
// Takes numbers from the front of bytes that may end too early.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

namespace curvecast::client {

/// Does not own the bytes. Once a call has returned false the position means nothing.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : left_(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) {}

  std::span<const std::uint8_t> left() const { return left_; }

  /// A little-endian number, or an array of them.
  template <typename T>
  bool read(T& value) {
    static_assert(std::is_trivially_copyable_v<T> && std::endian::native == std::endian::little);
    if (left_.size() < sizeof(T)) return false;
    std::memcpy(&value, left_.data(), sizeof(T));
    left_ = left_.subspan(sizeof(T));
    return true;
  }

  /// Seven bits to a byte, the lowest first; bits that T has no room for are dropped.
  template <typename T>
  bool read_varint(T& value) {
    constexpr unsigned kMostBytes = (8 * sizeof(T) + 6) / 7;
    value = 0;
    for (unsigned i = 0; i < kMostBytes; ++i) {
      std::uint8_t byte = 0;
      if (!read(byte)) return false;
      value |= static_cast<T>(byte & 127) << (7 * i);
      if (byte < 128) return true;
    }
    return false;
  }

  bool take(std::uint64_t count, std::span<const std::uint8_t>& bytes) {
    if (left_.size() < count) return false;
    bytes = left_.first(count);
    left_ = left_.subspan(count);
    return true;
  }

 private:
  std::span<const std::uint8_t> left_;
};

}  // namespace curvecast::client
