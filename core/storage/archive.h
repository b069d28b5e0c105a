// Small structures of mixed fields as bytes and back: little-endian, no gaps. A structure takes part by one function
//
//   template <typename Archive, ConstOr<Thing> T> void archive(Archive& fields, T& thing) {
//     auto& [first, second] = thing;   // does not compile any more once the structure has another number of fields
//     fields(first, second);
//   }
//
// that both directions use. Numbers, enumerations, strings, Vec3d and vectors, arrays and optionals of whatever takes part do so
// by themselves.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

template <typename T, typename U>
concept ConstOr = std::is_same_v<std::remove_const_t<T>, U>;

template <typename T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ArchiveWriter {
 public:
  static constexpr bool kReads = false;

  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  /// An enumeration whose last enumerator is `last`.
  template <typename T>
  void choice(const T& value, T /*last*/) {
    put(value);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <PlainNumber T>
  void put(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(const std::string& text) {
    put(std::uint64_t{text.size()});
    bytes_ += text;
  }
  void put(const Vec3d& v) { (*this)(v.x(), v.y(), v.z()); }
  template <typename T, std::size_t n>
  void put(const std::array<T, n>& values) {
    for (const T& value : values) put(value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(std::uint64_t{values.size()});
    for (const T& value : values) put(value);
  }
  template <typename T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <typename T>
  requires(std::is_class_v<T>) void put(const T& value) { archive(*this, value); }

  std::string bytes_;
};

/// What is missing reads as zeros, and ok() says so at the end.
class ArchiveReader {
 public:
  static constexpr bool kReads = true;

  explicit ArchiveReader(std::string_view bytes) : bytes_(bytes) {}
  /// Tells whether everything was there and within its limits, and nothing is left.
  bool ok() const { return ok_ && bytes_.empty(); }
  void fail() { ok_ = false; }

  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  template <typename T>
  void choice(T& value, T last) {
    get(value);
    if (value < T{} || value > last) {
      value = T{};
      fail();
    }
  }

 private:
  template <PlainNumber T>
  void get(T& value) {
    value = T{};
    if (bytes_.size() < sizeof value) return fail();
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
  }
  void get(std::string& text) {
    std::uint64_t size = 0;
    get(size);
    if (size > bytes_.size()) return fail();
    text = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
  }
  void get(Vec3d& v) { (*this)(v.x(), v.y(), v.z()); }
  template <typename T, std::size_t n>
  void get(std::array<T, n>& values) {
    for (T& value : values) get(value);
  }
  template <typename T>
  void get(std::vector<T>& values) {
    std::uint64_t size = 0;
    get(size);
    values.clear();
    for (std::uint64_t i = 0; i < size && ok_; ++i) {
      if (bytes_.empty()) return fail();  // every element takes a byte at least: no count is believed
      get(values.emplace_back());
    }
  }
  template <typename T>
  void get(std::optional<T>& value) {
    std::uint8_t is_there = 0;
    choice(is_there, std::uint8_t{1});
    value.reset();
    if (is_there != 0) get(value.emplace());
  }
  template <typename T>
  requires(std::is_class_v<T>) void get(T& value) { archive(*this, value); }

  std::string_view bytes_;
  bool ok_ = true;
};

template <typename T>
std::string to_archive(const T& value) {
  ArchiveWriter writer;
  writer(value);
  return writer.bytes();
}

/// False when the bytes are no T.
template <typename T>
bool from_archive(std::string_view bytes, T& value) {
  ArchiveReader reader(bytes);
  reader(value);
  return reader.ok();
}

}  // namespace curvecast
