// Bytes of a message in the making: fixed-size values lie in it little-endian, as on the machines that we run on.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

namespace curvecast {

class ByteWriter {
 public:
  static_assert(std::endian::native == std::endian::little);

  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }

  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put_byte(int value) { bytes_.push_back(static_cast<char>(value)); }
  void put_bytes(std::span<const std::uint8_t> bytes) {
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }

  /// Seven bits a byte, the lowest first; all bytes but the last have the highest bit set.
  void put_varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) put_byte(static_cast<int>(value & 0x7f) | 0x80);
    put_byte(static_cast<int>(value));
  }

  std::size_t size() const { return bytes_.size(); }
  std::string take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace curvecast
