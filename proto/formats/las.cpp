// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/las.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "proto/formats/append_value.h"
#include "proto/formats/column_name.h"

// PDAL, Debian's library for such files, stands on GDAL and some hundred packages; what is written here are two fixed layouts.

namespace curvecast::formats {
namespace {

constexpr std::size_t kHeaderBytes = 375, kVlrHeaderBytes = 54, kExtraBytesRecord = 192;
constexpr std::size_t kPlainPointBytes = 30, kColourBytes = 6;
constexpr std::size_t kNameBytes = 32;
constexpr std::uint16_t kWellKnownText = 1 << 4;  // of the global encoding: has to be set for point formats from 6 on
constexpr double kMostSteps = std::numeric_limits<std::int32_t>::max();

enum ExtraType : std::uint8_t { kUnsignedLong = 5, kFloat = 9 };  // both of four bytes

/// What a point has beyond its format: a number in four bytes.
struct Extra {
  ExtraType type;
  const void* values;
  std::size_t stride, offset;  // numbers
  std::string name;
};

void append_text(std::string& out, std::string_view text, std::size_t bytes) {
  out.append(text.substr(0, bytes));
  out.append(bytes - std::min(bytes, text.size()), '\0');
}

std::vector<Extra> extras_of(const PointColumns& columns) {
  std::vector<Extra> extras;
  const auto add = [&extras](const auto& values, ExtraType type, const std::vector<std::string>& names) {
    if (values.empty()) return;
    for (std::size_t i = 0; i < names.size(); ++i) extras.push_back({type, values.data(), names.size(), i, names[i]});
  };
  add(columns.radii, kFloat, {"radius"});
  add(columns.normals, kFloat, {"NormalX", "NormalY", "NormalZ"});
  add(columns.curvatures, kFloat, {"curvature_min", "curvature_max"});
  add(columns.ranks, kUnsignedLong, {"rank"});
  add(columns.faces, kUnsignedLong, {"face"});
  add(columns.barycentric, kFloat, {"barycentric_2", "barycentric_3"});
  add(columns.directions, kFloat, {"direction_min_x", "direction_min_y", "direction_min_z"});
  std::set<std::string> names;
  for (const Extra& extra : extras) names.insert(extra.name);
  for (const NamedColumn& scalar : columns.scalars) {
    const std::string wanted = column_name(scalar.name).substr(0, kNameBytes);
    std::string name = wanted;
    for (int copy = 2; !names.insert(name).second; ++copy) {
      const std::string end = absl::StrCat("_", copy);
      name = wanted.substr(0, kNameBytes - end.size()) + end;
    }
    add(scalar.values, kFloat, {name});
  }
  return extras;
}

/// From a coordinate to the whole number that stands for it.
struct Lattice {
  std::array<double, 3> offset{};
  double step = 0.001;

  std::int32_t steps(double coordinate, int axis) const {
    return static_cast<std::int32_t>(std::clamp(std::round((coordinate - offset[axis]) / step), 0.0, kMostSteps));
  }
  double coordinate(std::int32_t steps, int axis) const { return steps * step + offset[axis]; }
};

Lattice lattice_of(const PointColumns& columns, const Box& box) {
  Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) lattice.offset[axis] = columns.origin[axis] + double{box.low[axis]};
  if (const double extent = box.extent(); extent > 0) {
    const int digits = static_cast<int>(std::ceil(std::log10(extent / kMostSteps)));
    // Through text: the double next to the decimal number, as other programs have it.
    lattice.step = std::stod(absl::StrCat("1e", digits));
    if (extent / lattice.step > kMostSteps) lattice.step *= 10;
  }
  return lattice;
}

std::string extra_bytes_record(const std::vector<Extra>& extras) {
  std::string out;
  append_value(out, std::uint16_t{0});
  append_text(out, "LASF_Spec", 16);
  append_value(out, std::uint16_t{4});
  append_value(out, static_cast<std::uint16_t>(extras.size() * kExtraBytesRecord));
  append_text(out, "Extra bytes", 32);
  for (const Extra& extra : extras) {
    const std::size_t begin = out.size();
    append_value(out, std::uint16_t{0});
    append_value(out, extra.type);
    append_value(out, std::uint8_t{0});  // options: no scale, no offset, no bounds
    append_text(out, extra.name, kNameBytes);
    out.append(begin + kExtraBytesRecord - out.size(), '\0');
  }
  return out;
}

/// Points as they lie in the file, and what the header says of them.
struct Records {
  std::string bytes;
  std::array<std::int32_t, 3> low{}, high{};  // steps
};

Records records_of(const PointColumns& columns, const Lattice& lattice, const std::vector<Extra>& extras, std::size_t point_bytes) {
  Records records;
  records.bytes.reserve(point_bytes * columns.size());
  records.low.fill(columns.size() > 0 ? std::numeric_limits<std::int32_t>::max() : 0);
  std::string& out = records.bytes;
  for (const std::uint32_t i : rank_order(columns)) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t steps = lattice.steps(columns.absolute(i, axis), axis);
      records.low[axis] = std::min(records.low[axis], steps);
      records.high[axis] = std::max(records.high[axis], steps);
      append_value(out, steps);
    }
    append_value(out, std::uint16_t{0});        // intensity
    append_value(out, std::uint8_t{1 << 4 | 1});  // the first of one return
    append_value(out, std::uint8_t{0});         // flags
    append_value(out, std::uint8_t{1});         // class: unclassified
    append_value(out, std::uint8_t{0});         // user data
    append_value(out, std::int16_t{0});         // scan angle
    append_value(out, std::uint16_t{0});        // point source
    append_value(out, double{0});               // GPS time
    if (!columns.colours.empty()) {
      for (const std::uint8_t channel : columns.colours[i]) append_value(out, static_cast<std::uint16_t>(channel * 257));
    }
    for (const Extra& extra : extras) {
      const std::size_t number = std::size_t{i} * extra.stride + extra.offset;
      out.append(static_cast<const char*>(extra.values) + number * sizeof(float), sizeof(float));
    }
  }
  return records;
}

std::string header(const PointColumns& columns, const Lattice& lattice, const Records& records, std::size_t point_bytes,
                   std::size_t offset_to_points) {
  const std::uint64_t points = columns.size();
  const std::uint32_t legacy_points = 0;  // formats from 6 on have none
  std::string out = "LASF";
  append_value(out, std::uint16_t{0});  // file source
  append_value(out, kWellKnownText);
  append_text(out, "", 16);  // project
  append_value(out, std::uint8_t{1});
  append_value(out, std::uint8_t{4});
  append_text(out, "OTHER", 32);
  append_text(out, "Curvecast", 32);
  append_value(out, std::uint32_t{0});  // no day and year of creation: the same points are the same bytes
  append_value(out, static_cast<std::uint16_t>(kHeaderBytes));
  append_value(out, static_cast<std::uint32_t>(offset_to_points));
  append_value(out, static_cast<std::uint32_t>(offset_to_points > kHeaderBytes ? 1 : 0));  // variable length records
  append_value(out, static_cast<std::uint8_t>(columns.colours.empty() ? 6 : 7));
  append_value(out, static_cast<std::uint16_t>(point_bytes));
  append_value(out, legacy_points);
  append_value(out, std::array<std::uint32_t, 5>{});
  append_value(out, std::array<double, 3>{lattice.step, lattice.step, lattice.step});
  append_value(out, lattice.offset);
  for (int axis = 0; axis < 3; ++axis) {
    append_value(out, lattice.coordinate(records.high[axis], axis));
    append_value(out, lattice.coordinate(records.low[axis], axis));
  }
  append_value(out, std::uint64_t{0});  // waveforms
  append_value(out, std::uint64_t{0});  // extended records: where,
  append_value(out, std::uint32_t{0});  // and how many
  append_value(out, points);
  append_value(out, std::array<std::uint64_t, 15>{points});  // by return
  return out;
}

}  // namespace

absl::StatusOr<std::string> make_las(const PointColumns& columns) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  const std::vector<Extra> extras = extras_of(columns);
  const std::size_t extra_bytes = extras.size() * kExtraBytesRecord;
  if (extra_bytes > std::numeric_limits<std::uint16_t>::max()) {
    return absl::InvalidArgumentError(absl::StrFormat("%d numbers of each point are more than a .las file holds", extras.size()));
  }
  const std::size_t point_bytes =
      kPlainPointBytes + (columns.colours.empty() ? 0 : kColourBytes) + extras.size() * sizeof(float);
  const Lattice lattice = columns.size() > 0 ? lattice_of(columns, box_of(columns.positions)) : Lattice{};
  const Records records = records_of(columns, lattice, extras, point_bytes);
  const std::size_t offset = kHeaderBytes + (extras.empty() ? 0 : kVlrHeaderBytes + extra_bytes);
  std::string out = header(columns, lattice, records, point_bytes, offset);
  if (!extras.empty()) out += extra_bytes_record(extras);
  out += records.bytes;
  return out;
}

}  // namespace curvecast::formats
