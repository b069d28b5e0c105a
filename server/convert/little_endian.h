// Numbers as bytes of messages.
#pragma once

#include <bit>
#include <cstddef>
#include <string>

namespace curvecast::server {

/// Elements [begin, begin + count) of a vector or column as little-endian bytes, one after the other: numbers, or plain arrays of
/// them.
template <class Values>
std::string little_endian(const Values& values, std::size_t begin, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  return std::string(reinterpret_cast<const char*>(values.data() + begin), count * sizeof(typename Values::value_type));
}

}  // namespace curvecast::server
