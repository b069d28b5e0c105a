// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/npy.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <set>
#include <utility>
#include <vector>

#include "proto/formats/append_value.h"
#include "proto/formats/column_name.h"
#include "proto/formats/zip_archive.h"

namespace curvecast::formats {
namespace {

using Order = std::vector<std::uint32_t>;

constexpr std::size_t kAlignment = 64;  // of an array's first number in its file

/// `width`: numbers of a point; 1 makes an array of one dimension.
std::string header(std::string_view type, std::size_t points, std::size_t width) {
  const std::string shape = width == 1 ? absl::StrFormat("(%d,)", points) : absl::StrFormat("(%d, %d)", points, width);
  std::string text = absl::StrFormat("{'descr': '%s', 'fortran_order': False, 'shape': %s, }", type, shape);
  constexpr std::string_view kMagic("\x93NUMPY\x01\x00", 8);
  const std::size_t unpadded = kMagic.size() + sizeof(std::uint16_t) + text.size() + 1;
  text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string out(kMagic);
  append_value(out, static_cast<std::uint16_t>(text.size()));
  return out + text;
}

template <typename Value>
std::string array(std::string_view type, std::size_t width, std::span<const Value> values, const Order& order) {
  std::string out = header(type, values.size(), width);
  out.reserve(out.size() + values.size_bytes());
  for (const std::uint32_t i : order) append_value(out, values[i]);
  return out;
}

std::string positions(const PointColumns& columns, const Order& order) {
  if (columns.origin == std::array<double, 3>{}) return array("<f4", 3, columns.positions, order);
  std::string out = header("<f8", columns.size(), 3);
  out.reserve(out.size() + columns.size() * 3 * sizeof(double));
  for (const std::uint32_t i : order) {
    for (int axis = 0; axis < 3; ++axis) append_value(out, columns.absolute(i, axis));
  }
  return out;
}

}  // namespace

absl::StatusOr<std::string> make_npy(const PointColumns& columns) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  return positions(columns, rank_order(columns));
}

absl::StatusOr<std::string> make_npz(const PointColumns& columns) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  const Order order = rank_order(columns);
  std::vector<ZipEntry> entries = {{"positions.npy", positions(columns, order)}};
  const auto add = [&](const std::string& name, std::string_view type, std::size_t width, const auto& values) {
    if (!values.empty()) entries.push_back({name + ".npy", array(type, width, values, order)});
  };
  add("normals", "<f4", 3, columns.normals);
  add("radii", "<f4", 1, columns.radii);
  add("colours", "|u1", 3, columns.colours);
  add("curvatures", "<f4", 2, columns.curvatures);
  add("ranks", "<u4", 1, columns.ranks);
  add("faces", "<u4", 1, columns.faces);
  add("barycentric", "<f4", 2, columns.barycentric);
  add("directions", "<f4", 3, columns.directions);
  std::set<std::string> names;
  for (const NamedColumn& scalar : columns.scalars) {
    const std::string wanted = absl::StrCat("scalar ", column_name(scalar.name));
    std::string name = wanted;
    for (int copy = 2; !names.insert(name).second; ++copy) name = absl::StrCat(wanted, "_", copy);
    add(name, "<f4", 1, scalar.values);
  }
  return make_zip_archive(entries);
}

}  // namespace curvecast::formats
