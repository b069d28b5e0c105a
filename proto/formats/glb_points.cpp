// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/glb_points.h"

#include <meshoptimizer.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "proto/formats/append_value.h"
#include "proto/formats/glb_file.h"

namespace curvecast::formats {
namespace {

using Order = std::vector<std::uint32_t>;
using Component = GlbAttribute::Component;

constexpr double kSteps = std::numeric_limits<std::uint16_t>::max();
constexpr int kNormalBits = 8, kRadiusBits = 16;

/// `step`: units of a lattice whose zero is the box's corner; 0: floats.
GlbAttribute positions(const PointColumns& columns, const Order& order, const Box& box, double step) {
  GlbAttribute attribute{.semantic = "POSITION", .count = 3, .stride = 3 * sizeof(float)};
  attribute.low.assign(box.low.begin(), box.low.end());
  attribute.high.assign(box.high.begin(), box.high.end());
  if (step == 0) {
    for (const std::uint32_t i : order) append_value(attribute.bytes, columns.positions[i]);
    return attribute;
  }
  attribute.component = Component::kUnsignedShort;
  attribute.stride = 4 * sizeof(std::uint16_t);  // one more, for the alignment
  const auto quantise = [&box, step](float coordinate, int axis) {
    return static_cast<std::uint16_t>(std::lround((double{coordinate} - double{box.low[axis]}) / step));
  };
  for (const std::uint32_t i : order) {
    std::array<std::uint16_t, 4> steps{};
    for (int axis = 0; axis < 3; ++axis) steps[static_cast<std::size_t>(axis)] = quantise(columns.positions[i][axis], axis);
    append_value(attribute.bytes, steps);
  }
  for (int axis = 0; axis < 3; ++axis) {
    attribute.low[axis] = 0;
    attribute.high[axis] = quantise(box.high[axis], axis);
  }
  return attribute;
}

GlbAttribute normals(const PointColumns& columns, const Order& order, const GlbOptions& options) {
  GlbAttribute attribute{.semantic = "NORMAL", .count = 3, .stride = 3 * sizeof(float)};
  std::vector<std::array<float, 4>> unit;
  for (const std::uint32_t i : order) {
    const std::array<float, 3>& n = columns.normals[i];
    const double length = std::hypot(double{n[0]}, double{n[1]}, double{n[2]});
    unit.push_back({static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length), 0.0F});
  }
  if (!options.quantise) {
    for (const auto& [x, y, z, w] : unit) append_value(attribute.bytes, std::array<float, 3>{x, y, z});
    return attribute;
  }
  attribute.component = Component::kByte;
  attribute.normalised = true;
  attribute.stride = 4;
  if (options.compress) {
    attribute.filter = GlbAttribute::Filter::kOctahedral;
    attribute.bytes.resize(attribute.stride * unit.size());
    meshopt_encodeFilterOct(attribute.bytes.data(), unit.size(), attribute.stride, kNormalBits, unit.front().data());
    return attribute;
  }
  for (const std::array<float, 4>& n : unit) {
    for (const float coordinate : n) append_value(attribute.bytes, static_cast<std::int8_t>(std::lround(127 * double{coordinate})));
  }
  return attribute;
}

GlbAttribute radii(const PointColumns& columns, const Order& order, const GlbOptions& options) {
  GlbAttribute attribute{.semantic = "_RADIUS"};
  std::vector<float> values;
  for (const std::uint32_t i : order) values.push_back(columns.radii[i]);
  if (options.quantise && options.compress) {
    attribute.filter = GlbAttribute::Filter::kExponential;
    attribute.bytes.resize(attribute.stride * values.size());
    meshopt_encodeFilterExp(attribute.bytes.data(), values.size(), attribute.stride, kRadiusBits, values.data());
    return attribute;
  }
  for (const float value : values) append_value(attribute.bytes, value);
  return attribute;
}

}  // namespace

absl::StatusOr<std::string> make_glb(const PointColumns& columns, const GlbOptions& options) {
  if (absl::Status status = check_columns(columns); !status.ok()) return status;
  GlbPoints points{.size = columns.size(), .translation = columns.origin, .compress = options.compress};
  if (points.size == 0) return make_glb_file(points);  // which says that there are none
  const Box box = box_of(columns.positions);
  const Order order = rank_order(columns);
  double step = 0;
  if (options.quantise) {
    points.quantised = true;
    // The same step along all axes: another scale for each would turn the normals. Points that all lie together need some step, too.
    step = box.extent() > 0 ? box.extent() / kSteps : 1;
    points.scale = step;
    for (int axis = 0; axis < 3; ++axis) points.translation[axis] += double{box.low[axis]};
  }
  points.attributes.push_back(positions(columns, order, box, step));
  if (!columns.normals.empty()) points.attributes.push_back(normals(columns, order, options));
  if (!columns.colours.empty()) {
    std::vector<std::array<std::uint8_t, 3>> colours;
    for (const std::uint32_t i : order) colours.push_back(columns.colours[i]);
    points.attributes.push_back(colour_attribute(colours, 1));
  }
  if (!columns.radii.empty()) points.attributes.push_back(radii(columns, order, options));
  return make_glb_file(points);
}

}  // namespace curvecast::formats
