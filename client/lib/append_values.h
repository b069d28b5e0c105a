// SPDX-License-Identifier: Apache-2.0
// Numbers from the bytes of messages.
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <vector>

namespace curvecast::client {

/// Appends what little-endian bytes hold; false when they end within an element. T: numbers, or plain arrays of them.
template <typename T>
bool append_values(const std::string& bytes, std::vector<T>& values) {
  static_assert(std::endian::native == std::endian::little);
  if (bytes.size() % sizeof(T) != 0) return false;
  const std::size_t before = values.size();
  values.resize(before + bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data() + before, bytes.data(), bytes.size());
  return true;
}

}  // namespace curvecast::client
