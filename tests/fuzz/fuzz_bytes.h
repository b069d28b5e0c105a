// An input as a sequence of choices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace curvecast::fuzzing {

/// Reads an input from its beginning. What is missing at its end reads as zeros.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : rest_(reinterpret_cast<const char*>(data), size) {}

  template <typename T = std::uint8_t>
  T take() {
    static_assert(std::is_unsigned_v<T>);
    T value = 0;
    const std::string_view some = take_text(sizeof value);
    if (!some.empty()) std::memcpy(&value, some.data(), some.size());
    return value;
  }
  /// At most so many.
  std::string_view take_text(std::size_t size) {
    const std::string_view some = rest_.substr(0, size);
    rest_.remove_prefix(some.size());
    return some;
  }
  /// All up to the next `end`, which is skipped, or the end.
  std::string_view take_until(char end) {
    const std::string_view some = rest_.substr(0, rest_.find(end));
    rest_.remove_prefix(std::min(some.size() + 1, rest_.size()));
    return some;
  }
  std::string_view take_all() { return take_text(rest_.size()); }
  bool empty() const { return rest_.empty(); }
  std::size_t size() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

}  // namespace curvecast::fuzzing
