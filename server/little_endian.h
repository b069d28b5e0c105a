// Numbers as bytes of messages.
#pragma once

#include <bit>
#include <string>
#include <vector>

namespace curvecast::server {

/// Elements [begin, begin + count) as little-endian bytes, one after the other. T: numbers, or plain arrays of them.
template <class T>
std::string little_endian(const std::vector<T>& values, std::size_t begin, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  return std::string(reinterpret_cast<const char*>(values.data() + begin), count * sizeof(T));
}

}  // namespace curvecast::server
