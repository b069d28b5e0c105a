// SPDX-License-Identifier: Apache-2.0
// Numbers as the bytes of a file.
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

namespace curvecast::formats {

static_assert(std::endian::native == std::endian::little, "all formats here are little endian, and written as numbers lie in memory");

/// Appends the bytes of a number, or of an array of numbers.
template <typename Value>
  requires std::is_trivially_copyable_v<Value>
void append_value(std::string& out, const Value& value) {
  char bytes[sizeof(Value)];
  std::memcpy(bytes, &value, sizeof(Value));
  out.append(bytes, sizeof(Value));
}

}  // namespace curvecast::formats
