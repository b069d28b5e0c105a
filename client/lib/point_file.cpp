// SPDX-License-Identifier: Apache-2.0
#include "client/lib/point_file.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_format.h>

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "client/lib/file_bytes.h"
#include "client/lib/point_headers.h"
#include "client/lib/point_table.h"
#include "proto/formats/ply_name.h"

namespace curvecast::client {
namespace {

static_assert(std::endian::native == std::endian::little, "records are little endian and written as they lie in memory");

constexpr std::uint64_t kLargestFile = std::uint64_t{16} << 30;  // bytes

enum class Format { kPly, kXyz, kPcd };

absl::StatusOr<Format> format_of(const std::string& path) {
  const std::string ending = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (ending == ".ply") return Format::kPly;
  if (ending == ".xyz") return Format::kXyz;
  if (ending == ".pcd") return Format::kPcd;
  return absl::InvalidArgumentError("not a point file's name: it has to end in .ply, .xyz or .pcd");
}

struct Layout {
  bool normals;
  bool radii;
  bool doubles = false;        // x y z
  bool colours = false;        // red green blue, a byte each
  bool packed_colour = false;  // 0x00RRGGBB in four bytes
};

std::array<double, 3> absolute(const Points& points, std::size_t i) {
  std::array<double, 3> p;
  for (int axis = 0; axis < 3; ++axis) p[axis] = points.origin[axis] + double{points.positions[i][axis]};
  return p;
}

/// What a PLY file holds beyond: values that lie one after the other, and their properties.
struct Extra {
  const void* values;
  std::size_t bytes;  // of a point
  std::string properties;
};

std::vector<Extra> extras_of(const Points& points) {
  std::vector<Extra> extras;
  const auto add = [&extras](const auto& values, std::string properties) {
    if (!values.empty()) extras.push_back({values.data(), sizeof(values[0]), std::move(properties)});
  };
  add(points.curvatures, "property float curvature_min\nproperty float curvature_max\n");
  add(points.ranks, "property uint rank\n");
  add(points.faces, "property uint face\n");
  add(points.barycentric, "property float barycentric_2\nproperty float barycentric_3\n");
  add(points.directions, "property float direction_min_x\nproperty float direction_min_y\nproperty float direction_min_z\n");
  // As other programs name such columns.
  for (const auto& [name, values] : points.scalars)
    add(values, absl::StrFormat("property float scalar_%s\n", formats::ply_name(name)));
  return extras;
}

// One record per point: x y z [normal] [colour] [radius] [extras].
void append_records(const Points& points, const Layout& layout, const std::vector<Extra>& extras, std::string& out) {
  std::size_t extra_bytes = 0;
  for (const Extra& extra : extras) extra_bytes += extra.bytes;
  const std::size_t stride = (layout.doubles ? 24 : 12) + (layout.normals ? 12 : 0) + (layout.colours ? 3 : 0) +
                             (layout.packed_colour ? 4 : 0) + (layout.radii ? 4 : 0) + extra_bytes;
  const std::size_t header = out.size();
  out.resize(header + stride * points.size());
  char* p = out.data() + header;
  const auto put = [&p](const auto& value) {
    std::memcpy(p, &value, sizeof(value));
    p += sizeof(value);
  };
  constexpr std::array<float, 3> kNoNormal{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::array<double, 3> position = absolute(points, i);
    if (layout.doubles) {
      put(position);
    } else {
      for (const double coordinate : position) put(static_cast<float>(coordinate));
    }
    if (layout.normals) put(points.normals.empty() ? kNoNormal : points.normals[i]);
    if (layout.colours) put(points.colours[i]);
    if (layout.packed_colour) {
      const auto& [red, green, blue] = points.colours[i];
      put(std::uint32_t{red} << 16 | std::uint32_t{green} << 8 | std::uint32_t{blue});
    }
    if (layout.radii) put(points.radii.empty() ? 0.0F : points.radii[i]);
    for (const Extra& extra : extras) {
      std::memcpy(p, static_cast<const char*>(extra.values) + i * extra.bytes, extra.bytes);
      p += extra.bytes;
    }
  }
}

std::string make_ply(const Points& points) {
  const Layout layout{.normals = !points.normals.empty(),
                      .radii = !points.radii.empty(),
                      .doubles = points.origin != std::array<double, 3>{},
                      .colours = !points.colours.empty()};
  const char* const type = layout.doubles ? "double" : "float";
  std::string out = absl::StrFormat("ply\nformat binary_little_endian 1.0\nelement vertex %d\n", points.size());
  for (const char* axis : {"x", "y", "z"}) absl::StrAppendFormat(&out, "property %s %s\n", type, axis);
  if (layout.normals) out += "property float nx\nproperty float ny\nproperty float nz\n";
  if (layout.colours) out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (layout.radii) out += "property float radius\n";
  const std::vector<Extra> extras = extras_of(points);
  for (const Extra& extra : extras) out += extra.properties;
  out += "end_header\n";
  append_records(points, layout, extras, out);
  return out;
}

std::string make_pcd(const Points& points) {
  const bool coloured = !points.colours.empty();
  std::string out = absl::StrFormat(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z%s radius\n"
      "SIZE 4 4 4 4 4 4%s 4\nTYPE F F F F F F%s F\nCOUNT 1 1 1 1 1 1%s 1\nWIDTH %d\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS %d\nDATA binary\n",
      coloured ? " rgb" : "", coloured ? " 4" : "", coloured ? " U" : "", coloured ? " 1" : "", points.size(), points.size());
  append_records(points, {.normals = true, .radii = true, .packed_colour = coloured}, {}, out);
  return out;
}

std::string make_xyz(const Points& points) {
  const bool doubles = points.origin != std::array<double, 3>{};
  std::string out;
  const auto put = [&out](auto value) {
    char digits[32];
    out.append(digits, std::to_chars(std::begin(digits), std::end(digits), value).ptr);
    out += ' ';
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::array<double, 3> p = absolute(points, i);
    for (int axis = 0; axis < 3; ++axis) {
      doubles ? put(p[axis]) : put(points.positions[i][axis]);
    }
    // Six numbers would be taken for a place and a normal: colours stand behind normals, or behind zeros.
    if (!points.normals.empty() || !points.colours.empty()) {
      for (const float n : points.normals.empty() ? std::array<float, 3>{} : points.normals[i]) put(n);
    }
    if (!points.colours.empty()) {
      for (const std::uint8_t channel : points.colours[i]) put(int{channel});
    }
    out.back() = '\n';
  }
  return out;
}

absl::Status write_as(Format format, const std::string& path, const Points& points) {
  switch (format) {
    case Format::kPly:
      return write_bytes(path, make_ply(points));
    case Format::kXyz:
      return write_bytes(path, make_xyz(points));
    case Format::kPcd:
      return write_bytes(path, make_pcd(points));
  }
  return absl::InternalError("unknown point format");
}

absl::StatusOr<Points> parse_as(Format format, std::string_view bytes) {
  absl::StatusOr<PointTable> table = format == Format::kPly   ? parse_ply_points(bytes)
                                     : format == Format::kPcd ? parse_pcd_points(bytes)
                                                              : parse_xyz_points(bytes);
  if (!table.ok()) return table.status();
  return read_point_table(*table);
}

absl::Status in_file(const std::string& path, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrFormat("%s: %s", path, status.message()));
}

}  // namespace

absl::Status write_point_file(const std::string& path, const Points& points) {
  const absl::StatusOr<Format> format = format_of(path);
  if (!format.ok()) return in_file(path, format.status());
  const auto fits = [&points](std::size_t size) { return size == 0 || size == points.size(); };
  if (!fits(points.normals.size()) || !fits(points.radii.size()) || !fits(points.colours.size())) {
    return absl::InvalidArgumentError(absl::StrFormat("%s: %d positions do not go with %d normals, %d radii and %d colours", path,
                                                      points.size(), points.normals.size(), points.radii.size(),
                                                      points.colours.size()));
  }
  if (!fits(points.curvatures.size()) || !fits(points.ranks.size()) || !fits(points.faces.size()) ||
      !fits(points.barycentric.size()) || !fits(points.directions.size())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: %d positions do not go with %d curvatures, %d ranks, %d faces, %d places in them and %d directions",
                        path, points.size(), points.curvatures.size(), points.ranks.size(), points.faces.size(),
                        points.barycentric.size(), points.directions.size()));
  }
  for (const auto& [name, values] : points.scalars) {
    if (fits(values.size())) continue;
    return absl::InvalidArgumentError(
        absl::StrFormat("%s: %d positions do not go with %d values of %s", path, points.size(), values.size(), name));
  }
  try {
    return write_as(*format, path, points);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("%s: not enough memory to write the points", path));
  }
}

absl::StatusOr<Points> read_point_file(const std::string& path) {
  const absl::StatusOr<Format> format = format_of(path);
  if (!format.ok()) return in_file(path, format.status());
  try {
    const absl::StatusOr<std::string> bytes = read_bytes(path, kLargestFile);
    if (!bytes.ok()) return bytes.status();  // names the path already
    absl::StatusOr<Points> points = parse_as(*format, *bytes);
    if (!points.ok()) return in_file(path, points.status());
    return points;
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrFormat("%s: not enough memory to read the points", path));
  } catch (const std::length_error&) {
    return absl::ResourceExhaustedError(absl::StrFormat("%s: not enough memory to read the points", path));
  }
}

}  // namespace curvecast::client
