#include "core/mesh_io/ply_header.h"

#include <absl/strings/str_format.h>

#include <optional>
#include <utility>

#include "core/base/text_scanner.h"

namespace curvecast {
namespace {

std::optional<PlyType> type_by_name(std::string_view name) {
  constexpr std::pair<std::string_view, PlyType> kNames[] = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  for (const auto& [known, type] : kNames) {
    if (name == known) return type;
  }
  return std::nullopt;
}

class HeaderParser {
 public:
  explicit HeaderParser(std::string_view bytes)
      : scanner_(bytes), cr_only_(bytes.starts_with("ply\r") && !bytes.starts_with("ply\r\n")) {}

  absl::StatusOr<PlyHeader> parse() {
    if (next_word() != "ply" || !scanner_.at_line_end()) return scanner_.error("a PLY file begins with a line 'ply'");
    for (;;) {
      scanner_.next_line();
      if (scanner_.at_end()) return scanner_.error("the file ends within the header ('end_header' is missing)");
      const std::string_view keyword = next_word();
      absl::Status status;
      if (keyword == "end_header") break;
      if (keyword == "format") {
        status = parse_format();
      } else if (keyword == "element") {
        status = parse_element();
      } else if (keyword == "property") {
        status = parse_property();
      } else if (keyword == "comment") {
        parse_comment();
      } else if (keyword != "obj_info" && !keyword.empty()) {
        status = scanner_.error(absl::StrFormat("unknown keyword in the header: '%s'", printable(keyword)));
      }
      if (!status.ok()) return status;
    }
    if (!has_format_) return scanner_.error("the header has no line 'format'");
    return finish();
  }

 private:
  std::string_view next_word() {
    scanner_.skip_blanks();
    const std::string_view word = scanner_.word();
    scanner_.skip_blanks();
    return word;
  }

  absl::StatusOr<PlyType> next_type() {
    scanner_.skip_blanks();
    const std::optional<PlyType> type = type_by_name(scanner_.peek_word());
    if (!type) return scanner_.expected("a type (char, uchar, short, ushort, int, uint, float or double)");
    scanner_.skip_word();
    return *type;
  }

  absl::Status parse_format() {
    const std::string_view format = scanner_.peek_word();
    if (format == "ascii") {
      header_.format = PlyFormat::kAscii;
    } else if (format == "binary_little_endian") {
      header_.format = PlyFormat::kBinaryLittleEndian;
    } else if (format == "binary_big_endian") {
      header_.format = PlyFormat::kBinaryBigEndian;
    } else {
      return scanner_.expected("ascii, binary_little_endian or binary_big_endian");
    }
    has_format_ = true;
    return absl::OkStatus();
  }

  void parse_comment() {
    if (next_word() != "TextureFile") return;
    std::string_view name = scanner_.line_rest();
    while (name.ends_with(' ') || name.ends_with('\t')) name.remove_suffix(1);
    if (!name.empty()) header_.textures.push_back({name, scanner_.line()});
  }

  absl::Status parse_element() {
    PlyElement element;
    element.name = next_word();
    std::int64_t count = 0;
    if (element.name.empty()) return scanner_.expected("the name of an element");
    if (!scanner_.integer(count)) return scanner_.expected("the number of elements");
    if (count < 0) return scanner_.error("the number of elements is negative");
    element.count = static_cast<std::uint64_t>(count);
    header_.elements.push_back(std::move(element));
    return absl::OkStatus();
  }

  absl::Status parse_property() {
    if (header_.elements.empty()) return scanner_.error("a property stands before the first element");
    PlyProperty property;
    if (scanner_.peek_word() == "list") {
      scanner_.skip_word();
      property.is_list = true;
      const absl::StatusOr<PlyType> count_type = next_type();
      if (!count_type.ok()) return count_type.status();
      if (!is_integer(*count_type)) return scanner_.error("the length of a list has to be of an integer type");
      property.count_type = *count_type;
    }
    const absl::StatusOr<PlyType> type = next_type();
    if (!type.ok()) return type.status();
    property.type = *type;
    property.name = next_word();
    if (property.name.empty()) return scanner_.expected("the name of a property");
    header_.elements.back().properties.push_back(property);
    return absl::OkStatus();
  }

  // The body begins right behind the line end of 'end_header'. In a file of bare CRs, an LF there is the first byte of the body.
  absl::StatusOr<PlyHeader> finish() {
    if (!scanner_.at_line_end()) return scanner_.expected("the end of the line");
    if (cr_only_) {
      if (!scanner_.at_end()) scanner_.skip_char();
    } else {
      scanner_.next_line();
    }
    header_.body_offset = scanner_.offset();
    header_.body_line = scanner_.line() + (cr_only_ ? 1 : 0);
    return std::move(header_);
  }

  TextScanner scanner_;
  bool cr_only_;
  bool has_format_ = false;
  PlyHeader header_;
};

}  // namespace

std::size_t ply_type_bytes(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 0;
}

absl::StatusOr<PlyHeader> parse_ply_header(std::string_view bytes) { return HeaderParser(bytes).parse(); }

}  // namespace curvecast
