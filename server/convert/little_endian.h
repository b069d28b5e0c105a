// Writes numbers as bytes of messages.
#pragma once

#include <bit>
#include <cstddef>
#include <string>

namespace curvecast::server {

/// Returns the bytes of elements [begin, begin + count) of a vector or column, one after the other, the lowest byte of a number
/// first. Elements are numbers or plain arrays of numbers.
template <class Values>
std::string little_endian(const Values& values, std::size_t begin, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  return std::string(reinterpret_cast<const char*>(values.data() + begin), count * sizeof(typename Values::value_type));
}

}  // namespace curvecast::server
