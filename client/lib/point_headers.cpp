// SPDX-License-Identifier: Apache-2.0
#include "client/lib/point_headers.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace curvecast::client {
namespace {

// Line by line through a header, with errors that name the line.
class HeaderLines {
 public:
  explicit HeaderLines(std::string_view bytes) : rest_(bytes) {}

  /// Goes to the next line; false at the end.
  bool next() {
    if (rest_.empty()) return false;
    line_ = take_line(rest_);
    ++number_;
    return true;
  }
  std::string_view word() { return take_word(line_); }
  std::string_view rest() const { return rest_; }
  std::size_t number() const { return number_; }
  absl::Status error(const std::string& what) const {
    return absl::InvalidArgumentError(absl::StrFormat("line %d: %s", number_, what));
  }

 private:
  std::string_view rest_;
  std::string_view line_;
  std::size_t number_ = 0;
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PointColumn> columns;
  bool has_list = false;
};

bool parse_ply_type(std::string_view name, PointColumn& column) {
  struct Type {
    std::string_view name;
    std::string_view other_name;
    ColumnKind kind;
    std::size_t bytes;
  };
  constexpr Type kTypes[] = {{"char", "int8", ColumnKind::kSigned, 1},    {"uchar", "uint8", ColumnKind::kUnsigned, 1},
                             {"short", "int16", ColumnKind::kSigned, 2},  {"ushort", "uint16", ColumnKind::kUnsigned, 2},
                             {"int", "int32", ColumnKind::kSigned, 4},    {"uint", "uint32", ColumnKind::kUnsigned, 4},
                             {"float", "float32", ColumnKind::kFloat, 4}, {"double", "float64", ColumnKind::kFloat, 8}};
  for (const Type& type : kTypes) {
    if (name != type.name && name != type.other_name) continue;
    column.kind = type.kind;
    column.bytes = type.bytes;
    return true;
  }
  return false;
}

// Moves the body of `table` behind `element`.
absl::Status skip_ply_element(const PlyElement& element, PointTable& table) {
  if (!table.binary) {
    for (std::uint64_t i = 0; i < element.count && !table.body.empty(); ++i, ++table.first_line) take_line(table.body);
    return absl::OkStatus();
  }
  if (element.has_list) return absl::InvalidArgumentError("elements with lists before the element 'vertex' are not supported");
  std::size_t stride = 0;
  for (const PointColumn& column : element.columns) stride += column.bytes;
  if (stride == 0) return absl::OkStatus();
  if (element.count > table.body.size() / stride) {
    return absl::InvalidArgumentError("the file ends before the element 'vertex'");
  }
  table.body.remove_prefix(element.count * stride);
  return absl::OkStatus();
}

absl::Status parse_ply_line(std::string_view keyword, HeaderLines& lines, PointTable& table, std::vector<PlyElement>& elements) {
  if (keyword == "format") {
    const std::string_view format = lines.word();
    if (format == "binary_big_endian") return lines.error("big endian point files are not supported; save it as little endian");
    if (format != "ascii" && format != "binary_little_endian") return lines.error("expected ascii or binary_little_endian");
    table.binary = format == "binary_little_endian";
  } else if (keyword == "element") {
    PlyElement element;
    element.name = lines.word();
    if (!parse_number(lines.word(), element.count)) return lines.error("expected the number of elements");
    elements.push_back(std::move(element));
  } else if (keyword == "property") {
    if (elements.empty()) return lines.error("a property stands before the first element");
    PointColumn column;
    const std::string_view type = lines.word();
    if (type == "list") {
      elements.back().has_list = true;
      return absl::OkStatus();
    }
    if (!parse_ply_type(type, column)) return lines.error("unknown type of a property");
    column.name = lines.word();
    elements.back().columns.push_back(column);
  } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
    return lines.error("unknown keyword in the header");
  }
  return absl::OkStatus();
}

// As many numbers as there are columns.
absl::Status read_pcd_numbers(HeaderLines& lines, std::vector<PointColumn>& columns, std::size_t PointColumn::*member) {
  for (PointColumn& column : columns) {
    constexpr std::uint64_t kLargest = 1 << 20;  // keeps sums of all columns far from overflow
    std::uint64_t value = 0;
    if (!parse_number(lines.word(), value) || value == 0 || value > kLargest) {
      return lines.error("expected a number from 1 to 1048576 for each field");
    }
    column.*member = value;
  }
  return absl::OkStatus();
}

absl::Status read_pcd_types(HeaderLines& lines, std::vector<PointColumn>& columns) {
  for (PointColumn& column : columns) {
    const std::string_view type = lines.word();
    if (type != "I" && type != "U" && type != "F") return lines.error("expected I, U or F for each field");
    column.kind = type == "I" ? ColumnKind::kSigned : type == "U" ? ColumnKind::kUnsigned : ColumnKind::kFloat;
  }
  return absl::OkStatus();
}

absl::Status check_pcd_columns(const HeaderLines& lines, const std::vector<PointColumn>& columns) {
  for (const PointColumn& column : columns) {
    const std::size_t n = column.bytes;
    const bool good = column.kind == ColumnKind::kFloat ? n == 4 || n == 8 : n == 1 || n == 2 || n == 4 || n == 8;
    if (!good) return lines.error("a field has a SIZE that its TYPE cannot have");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PointTable> parse_ply_points(std::string_view bytes) {
  HeaderLines lines(bytes);
  PointTable table;
  std::vector<PlyElement> elements;
  if (!lines.next() || lines.word() != "ply") return lines.error("a PLY file begins with a line 'ply'");
  for (;;) {
    if (!lines.next()) return lines.error("the file ends within the header ('end_header' is missing)");
    const std::string_view keyword = lines.word();
    if (keyword == "end_header") break;
    if (absl::Status status = parse_ply_line(keyword, lines, table, elements); !status.ok()) return status;
  }
  table.body = lines.rest();
  table.first_line = lines.number() + 1;
  for (PlyElement& element : elements) {
    if (element.name != "vertex") {
      if (absl::Status status = skip_ply_element(element, table); !status.ok()) return status;
      continue;
    }
    if (element.has_list) return absl::InvalidArgumentError("lists in the element 'vertex' are not supported");
    table.columns = std::move(element.columns);
    table.rows = element.count;
    return table;
  }
  return absl::InvalidArgumentError("the header has no element 'vertex'");
}

absl::StatusOr<PointTable> parse_pcd_points(std::string_view bytes) {
  HeaderLines lines(bytes);
  PointTable table;
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  for (;;) {
    if (!lines.next()) return lines.error("the file ends within the header ('DATA' is missing)");
    const std::string_view keyword = lines.word();
    absl::Status status;
    std::uint64_t points = 0;
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      table.columns.clear();
      for (std::string_view name = lines.word(); !name.empty(); name = lines.word()) table.columns.push_back({.name = name});
    } else if (keyword == "SIZE") {
      status = read_pcd_numbers(lines, table.columns, &PointColumn::bytes);
    } else if (keyword == "COUNT") {
      status = read_pcd_numbers(lines, table.columns, &PointColumn::count);
    } else if (keyword == "TYPE") {
      status = read_pcd_types(lines, table.columns);
    } else if (keyword == "WIDTH" || keyword == "HEIGHT") {
      std::uint64_t& side = keyword == "WIDTH" ? width : height;
      if (!parse_number(lines.word(), side) || side > UINT32_MAX) status = lines.error("expected a number below 2^32");
    } else if (keyword == "POINTS") {
      if (!parse_number(lines.word(), points)) status = lines.error("expected the number of points");
      table.rows = points;
    } else if (keyword == "DATA") {
      break;
    } else if (!keyword.empty() && keyword.front() != '#' && keyword != "VERSION" && keyword != "VIEWPOINT") {
      status = lines.error("unknown keyword in the header");
    }
    if (!status.ok()) return status;
  }
  const std::string_view data = lines.word();
  if (data == "binary_compressed") return lines.error("compressed PCD is not supported; save it as binary or ascii");
  if (data != "ascii" && data != "binary") return lines.error("expected ascii or binary");
  if (absl::Status status = check_pcd_columns(lines, table.columns); !status.ok()) return status;
  if (!table.rows) table.rows = width * height;
  table.binary = data == "binary";
  table.body = lines.rest();
  table.first_line = lines.number() + 1;
  return table;
}

absl::StatusOr<PointTable> parse_xyz_points(std::string_view bytes) {
  constexpr std::array<std::string_view, 9> kNames = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
  PointTable table;
  table.body = bytes;
  HeaderLines lines(bytes);
  std::size_t words = 0;
  while (words == 0 && lines.next()) {
    std::string_view word = lines.word();
    if (word.starts_with('#') || word.starts_with("//")) continue;
    for (; !word.empty(); word = lines.word()) ++words;
  }
  if (words < 3) return lines.error("expected x y z, or x y z nx ny nz");
  const std::size_t columns = words < 6 ? 3 : words == kNames.size() ? words : 6;
  for (std::size_t i = 0; i < columns; ++i) {
    table.columns.push_back({.name = kNames[i], .kind = i < 6 ? ColumnKind::kFloat : ColumnKind::kUnsigned});
  }
  return table;
}

}  // namespace curvecast::client
