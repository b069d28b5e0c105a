// The body of a PLY file as a sequence of scalars, the same for text and for both byte orders.
#pragma once

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/text_scanner.h"
#include "core/mesh_io/ply_header.h"
#include "core/mesh_io/reading/endian.h"

namespace curvecast {

/// A body in text. Words are taken in their order; line ends count as any other space.
class PlyTextSource {
 public:
  PlyTextSource(std::string_view bytes, const PlyHeader& header)
      : scanner_(bytes.substr(header.body_offset), header.body_line), body_offset_(header.body_offset) {}

  /// Returns how many bytes of the file were read so far.
  std::size_t offset() const { return body_offset_ + scanner_.offset(); }
  /// Most scalars that the rest can hold: a digit and a space each, the last space may be missing.
  std::uint64_t scalars_left() const { return (scanner_.remaining() + 1) / 2; }
  /// Most elements like this that the rest can hold.
  std::uint64_t capacity(const PlyElement& element) const { return scalars_left() / element.properties.size(); }

  /// False when no such number comes next.
  bool real(PlyType, double& value) {
    scanner_.skip_space();
    return scanner_.number(value);
  }
  bool integer(PlyType, std::int64_t& value) {
    scanner_.skip_space();
    return scanner_.integer(value);
  }
  /// Over `count` scalars; false when the body ends before.
  bool skip(PlyType, std::uint64_t count) {
    for (; count > 0; --count) {
      scanner_.skip_space();
      if (scanner_.at_end()) return false;
      scanner_.skip_word();
    }
    return true;
  }

  /// Words the error for a fault in the element `number` of its kind.
  absl::Status error(std::string_view, std::uint64_t, std::string_view message) const { return scanner_.error(message); }
  /// Words the error for an element in which real, integer or skip returned false.
  absl::Status missing(const PlyElement& element, std::uint64_t number) const {
    return scanner_.expected(absl::StrFormat("a number of %s %d of %d", printable(element.name), number, element.count));
  }

 private:
  TextScanner scanner_;
  std::size_t body_offset_;
};

/// A body in binary; kSwap when its byte order is not the machine's.
template <bool kSwap>
class PlyBinarySource {
 public:
  PlyBinarySource(std::string_view bytes, const PlyHeader& header)
      : begin_(bytes.data()), p_(begin_ + header.body_offset), end_(begin_ + bytes.size()) {}

  std::size_t offset() const { return static_cast<std::size_t>(p_ - begin_); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - p_); }
  std::uint64_t scalars_left() const { return remaining(); }
  std::uint64_t capacity(const PlyElement& element) const {
    std::uint64_t smallest = 0;
    for (const PlyProperty& property : element.properties) {
      smallest += ply_type_bytes(property.is_list ? property.count_type : property.type);
    }
    return remaining() / smallest;
  }
  template <class T>
  static T at(const char* p) {
    return load<T, kSwap>(p);
  }
  /// Returns the next byte; valid bytes follow up to remaining().
  const char* data() const { return p_; }
  void advance(std::size_t bytes) { p_ += bytes; }

  bool real(PlyType type, double& value) {
    if (remaining() < ply_type_bytes(type)) return false;
    value = real_at(p_, type);
    p_ += ply_type_bytes(type);
    return true;
  }
  bool integer(PlyType type, std::int64_t& value) {
    if (remaining() < ply_type_bytes(type)) return false;
    value = integer_at(p_, type);
    p_ += ply_type_bytes(type);
    return true;
  }
  bool skip(PlyType type, std::uint64_t count) {
    if (remaining() / ply_type_bytes(type) < count) return false;
    p_ += count * ply_type_bytes(type);
    return true;
  }

  absl::Status error(std::string_view kind, std::uint64_t number, std::string_view message) const {
    return absl::InvalidArgumentError(absl::StrFormat("%s %d: %s", printable(kind), number, message));
  }
  absl::Status missing(const PlyElement& element, std::uint64_t number) const {
    return error(element.name, number, absl::StrFormat("the file ends here, but its header claims %d of these", element.count));
  }

 private:
  static std::int64_t integer_at(const char* p, PlyType type) {
    switch (type) {
      case PlyType::kInt8:
        return at<std::int8_t>(p);
      case PlyType::kUint8:
        return at<std::uint8_t>(p);
      case PlyType::kInt16:
        return at<std::int16_t>(p);
      case PlyType::kUint16:
        return at<std::uint16_t>(p);
      case PlyType::kInt32:
        return at<std::int32_t>(p);
      default:
        return at<std::uint32_t>(p);
    }
  }
  static double real_at(const char* p, PlyType type) {
    if (type == PlyType::kFloat32) return at<float>(p);
    if (type == PlyType::kFloat64) return at<double>(p);
    return static_cast<double>(integer_at(p, type));
  }

  const char* begin_;
  const char* p_;
  const char* end_;
};

}  // namespace curvecast
