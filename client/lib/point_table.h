// SPDX-License-Identifier: Apache-2.0
// A point file's body as a table: what PLY, PCD and XYZ come to once their headers are understood.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "client/lib/points.h"

namespace curvecast::client {

enum class ColumnKind { kSigned, kUnsigned, kFloat };

struct PointColumn {
  std::string_view name;  // x y z nx ny nz normal_x normal_y normal_z red green blue rgb radius; others are skipped
  ColumnKind kind = ColumnKind::kFloat;
  std::size_t bytes = 4;  // of a scalar: 1, 2, 4 or 8; 4 or 8 for kFloat
  std::size_t count = 1;  // scalars in a row
};

struct PointTable {
  std::vector<PointColumn> columns;   // in the order of a row
  std::optional<std::uint64_t> rows;  // unknown: as many as there are
  bool binary = false;                // little endian, packed; else text, a line per row
  std::string_view body;
  std::size_t first_line = 1;  // number of the body's first line, for text
};

/// InvalidArgument, naming the line (text) or the point from 0 (binary), when a row is broken or missing, a number not finite,
/// or a column x, y or z absent. See read_point_file for the origin.
absl::StatusOr<Points> read_point_table(const PointTable& table);

// ------------------------------------------------------------------------------------------------- text, for headers as well

/// Takes the next line (without its end, LF or CR LF) off the front of `text`.
std::string_view take_line(std::string_view& text);
/// Takes the next word off the front of `line`; empty when there is none.
std::string_view take_word(std::string_view& line);
/// The whole word as a number; false, with `value` untouched, when it is none.
bool parse_number(std::string_view word, double& value);
bool parse_number(std::string_view word, std::uint64_t& value);

}  // namespace curvecast::client
