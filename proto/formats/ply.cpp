// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/ply.h"

#include <absl/strings/str_format.h>

#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include "proto/formats/ply_name.h"

namespace curvecast::formats {
namespace {

static_assert(std::endian::native == std::endian::little, "records are little endian and written as they lie in memory");

/// Values that lie one after the other, and their properties.
struct Values {
  const void* first;
  std::size_t bytes;  // of a point
  std::string properties;
};

std::vector<Values> values_of(const PointColumns& columns) {
  std::vector<Values> all;
  const auto add = [&all](const auto& values, std::string properties) {
    if (!values.empty()) all.push_back({values.data(), sizeof(values[0]), std::move(properties)});
  };
  add(columns.normals, "property float nx\nproperty float ny\nproperty float nz\n");
  add(columns.colours, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
  add(columns.radii, "property float radius\n");
  add(columns.curvatures, "property float curvature_min\nproperty float curvature_max\n");
  add(columns.ranks, "property uint rank\n");
  add(columns.faces, "property uint face\n");
  add(columns.barycentric, "property float barycentric_2\nproperty float barycentric_3\n");
  add(columns.directions, "property float direction_min_x\nproperty float direction_min_y\nproperty float direction_min_z\n");
  // As other programs name such columns.
  for (const auto& [name, values] : columns.scalars) add(values, absl::StrFormat("property float scalar_%s\n", ply_name(name)));
  return all;
}

}  // namespace

absl::StatusOr<std::string> make_ply(const PointColumns& columns) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  const bool has_doubles = columns.origin != std::array<double, 3>{};
  const std::vector<Values> all = values_of(columns);
  std::size_t stride = has_doubles ? 24 : 12;
  std::string out = absl::StrFormat("ply\nformat binary_little_endian 1.0\nelement vertex %d\n", columns.size());
  for (const char* axis : {"x", "y", "z"})
    absl::StrAppendFormat(&out, "property %s %s\n", has_doubles ? "double" : "float", axis);
  for (const Values& values : all) {
    out += values.properties;
    stride += values.bytes;
  }
  out += "end_header\n";
  const std::size_t header = out.size();
  out.resize(header + stride * columns.size());
  char* p = out.data() + header;
  const auto put = [&p](const void* value, std::size_t bytes) {
    std::memcpy(p, value, bytes);
    p += bytes;
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double coordinate = columns.absolute(i, axis);
      const auto single = static_cast<float>(coordinate);
      has_doubles ? put(&coordinate, sizeof coordinate) : put(&single, sizeof single);
    }
    for (const Values& values : all) put(static_cast<const char*>(values.first) + i * values.bytes, values.bytes);
  }
  return out;
}

}  // namespace curvecast::formats
