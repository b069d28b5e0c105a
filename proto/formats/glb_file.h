// SPDX-License-Identifier: Apache-2.0
// The frame of a .glb file with one set of points. Sources: Khronos, glTF 2.0 specification, 5.1 and 4.4; EXT_meshopt_compression.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace curvecast::formats {

/// Numbers of each point, as an accessor has them.
struct GlbAttribute {
  enum class Component : std::uint16_t { kByte = 5120, kUnsignedShort = 5123, kFloat = 5126 };
  enum class Filter { kNone, kOctahedral, kExponential };  // what meshopt's decoder undoes

  std::string semantic;
  Component component = Component::kFloat;
  bool normalised = false;
  int count = 1;        // of components
  std::size_t stride = 4;  // bytes of a point, with padding: a multiple of 4
  std::string bytes;    // stride bytes for each point; with a filter, as its encoder has made them
  Filter filter = Filter::kNone;
  std::vector<double> low, high;  // of each component; empty: not said
};

struct GlbPoints {
  std::size_t size = 0;
  std::vector<GlbAttribute> attributes;
  std::array<double, 3> translation{};  // of the node
  double scale = 1;
  bool quantised = false;  // KHR_mesh_quantization
  bool splats = false;     // KHR_gaussian_splatting
  bool compress = false;   // EXT_meshopt_compression
};

/// Returns the file. Without compression the attributes of a point lie together, so that the first bytes of the file are the first
/// points; with it, each attribute is a stream. InvalidArgument: no points. ResourceExhausted: more than 4 GiB.
absl::StatusOr<std::string> make_glb_file(const GlbPoints& points);

/// Returns COLOR_0: linear, 16 bits a channel, of points with an opacity from 0 to 1. `colours` are in order.
GlbAttribute colour_attribute(const std::vector<std::array<std::uint8_t, 3>>& colours, double opacity);

}  // namespace curvecast::formats
