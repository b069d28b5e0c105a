// SPDX-License-Identifier: Apache-2.0
#include "proto/formats/glb_file.h"

#include <absl/strings/str_format.h>
#include <meshoptimizer.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "proto/formats/append_value.h"

namespace curvecast::formats {
namespace {

using Json = nlohmann::json;

constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr std::uint32_t kPoints = 0, kVertices = 34962;  // mode of a primitive, target of a view
constexpr char kCompression[] = "EXT_meshopt_compression";

const char* name_of(GlbAttribute::Filter filter) {
  switch (filter) {
    case GlbAttribute::Filter::kOctahedral:
      return "OCTAHEDRAL";
    case GlbAttribute::Filter::kExponential:
      return "EXPONENTIAL";
    case GlbAttribute::Filter::kNone:
      break;
  }
  return "NONE";
}

/// What the JSON says of the bytes, and the bytes.
struct Contents {
  Json buffers = Json::array(), views = Json::array(), accessors = Json::array();
  std::string bytes;
};

Json accessor_of(const GlbAttribute& attribute, std::size_t points, std::size_t view, std::size_t offset) {
  constexpr std::array kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  Json accessor = {{"bufferView", view},
                   {"componentType", static_cast<int>(attribute.component)},
                   {"count", points},
                   {"type", kTypes.at(static_cast<std::size_t>(attribute.count - 1))}};
  if (offset > 0) accessor["byteOffset"] = offset;
  if (attribute.normalised) accessor["normalized"] = true;
  if (!attribute.low.empty()) {
    accessor["min"] = attribute.low;
    accessor["max"] = attribute.high;
  }
  return accessor;
}

/// Point after point.
Contents interleave(const GlbPoints& points) {
  Contents contents;
  std::size_t stride = 0;
  for (const GlbAttribute& attribute : points.attributes) {
    contents.accessors.push_back(accessor_of(attribute, points.size, 0, stride));
    stride += attribute.stride;
  }
  contents.bytes.reserve(stride * points.size);
  for (std::size_t i = 0; i < points.size; ++i) {
    for (const GlbAttribute& attribute : points.attributes) {
      contents.bytes.append(attribute.bytes, i * attribute.stride, attribute.stride);
    }
  }
  contents.views.push_back(
      {{"buffer", 0}, {"byteLength", contents.bytes.size()}, {"byteStride", stride}, {"target", kVertices}});
  contents.buffers.push_back({{"byteLength", contents.bytes.size()}});
  return contents;
}

/// Attribute after attribute: filters are for those that have a view of their own.
absl::StatusOr<Contents> compress(const GlbPoints& points) {
  Contents contents;
  std::size_t plain_bytes = 0;
  for (std::size_t view = 0; view < points.attributes.size(); ++view) {
    const GlbAttribute& attribute = points.attributes[view];
    contents.accessors.push_back(accessor_of(attribute, points.size, view, 0));
    std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(points.size, attribute.stride));
    encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), attribute.bytes.data(), points.size, attribute.stride));
    if (encoded.empty()) return absl::InternalError("points cannot be compressed");
    Json compressed = {{"buffer", 0},
                       {"byteOffset", contents.bytes.size()},
                       {"byteLength", encoded.size()},
                       {"byteStride", attribute.stride},
                       {"count", points.size},
                       {"mode", "ATTRIBUTES"}};
    if (attribute.filter != GlbAttribute::Filter::kNone) compressed["filter"] = name_of(attribute.filter);
    contents.views.push_back({{"buffer", 1},
                              {"byteOffset", plain_bytes},
                              {"byteLength", attribute.bytes.size()},
                              {"byteStride", attribute.stride},
                              {"target", kVertices},
                              {"extensions", {{kCompression, std::move(compressed)}}}});
    plain_bytes += attribute.bytes.size();
    contents.bytes.append(encoded.begin(), encoded.end());
    contents.bytes.append((4 - contents.bytes.size() % 4) % 4, '\0');
  }
  contents.buffers.push_back({{"byteLength", contents.bytes.size()}});
  contents.buffers.push_back({{"byteLength", plain_bytes}, {"extensions", {{kCompression, {{"fallback", true}}}}}});
  return contents;
}

Json document_of(const GlbPoints& points, Contents& contents) {
  Json attributes = Json::object();
  for (std::size_t i = 0; i < points.attributes.size(); ++i) attributes[points.attributes[i].semantic] = i;
  Json primitive = {{"mode", kPoints}, {"attributes", std::move(attributes)}};
  Json node = {{"mesh", 0}};
  if (points.translation != std::array<double, 3>{}) node["translation"] = points.translation;
  if (points.scale != 1) node["scale"] = std::array<double, 3>{points.scale, points.scale, points.scale};
  Json used = Json::array(), required = Json::array();
  if (points.quantised) {
    used.push_back("KHR_mesh_quantization");
    required.push_back("KHR_mesh_quantization");
  }
  if (points.compress) {
    used.push_back(kCompression);
    required.push_back(kCompression);
  }
  if (points.splats) {
    used.push_back("KHR_gaussian_splatting");
    primitive["extensions"]["KHR_gaussian_splatting"] = {{"kernel", "ellipse"}, {"colorSpace", "srgb_rec709_display"}};
  }
  Json document = {{"asset", {{"version", "2.0"}, {"generator", "Curvecast"}}},
                   {"scene", 0},
                   {"scenes", {{{"nodes", {0}}}}},
                   {"nodes", {std::move(node)}},
                   {"meshes", {{{"primitives", {std::move(primitive)}}}}},
                   {"accessors", std::move(contents.accessors)},
                   {"bufferViews", std::move(contents.views)},
                   {"buffers", std::move(contents.buffers)}};
  if (!used.empty()) document["extensionsUsed"] = std::move(used);
  if (!required.empty()) document["extensionsRequired"] = std::move(required);
  return document;
}

/// From sRGB to light (IEC 61966-2-1).
double linear(std::uint8_t channel) {
  const double encoded = channel / 255.0;
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

}  // namespace

absl::StatusOr<std::string> make_glb_file(const GlbPoints& points) {
  if (points.size == 0) return absl::InvalidArgumentError("a .glb file holds one point at least");
  absl::StatusOr<Contents> contents = points.compress ? compress(points) : interleave(points);
  if (!contents.ok()) return contents.status();
  std::string json = document_of(points, *contents).dump();
  json.append((4 - json.size() % 4) % 4, ' ');
  constexpr std::size_t kFrame = 12 + 8 + 8;  // header, and those of the two chunks
  const std::size_t size = kFrame + json.size() + contents->bytes.size();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return absl::ResourceExhaustedError(absl::StrFormat("%d points are more than a .glb file of 4 GiB holds", points.size));
  }
  std::string out;
  out.reserve(size);
  for (const std::size_t number : {std::size_t{kMagic}, std::size_t{kVersion}, size, json.size(), std::size_t{kJsonChunk}}) {
    append_value(out, static_cast<std::uint32_t>(number));
  }
  out += json;
  append_value(out, static_cast<std::uint32_t>(contents->bytes.size()));
  append_value(out, kBinaryChunk);
  out += contents->bytes;
  return out;
}

GlbAttribute colour_attribute(const std::vector<std::array<std::uint8_t, 3>>& colours, double opacity) {
  constexpr double kOne = std::numeric_limits<std::uint16_t>::max();
  std::array<std::uint16_t, 256> of_channel{};
  for (std::size_t i = 0; i < of_channel.size(); ++i) {
    of_channel[i] = static_cast<std::uint16_t>(std::lround(kOne * linear(static_cast<std::uint8_t>(i))));
  }
  const auto alpha = static_cast<std::uint16_t>(std::lround(kOne * opacity));
  GlbAttribute attribute{.semantic = "COLOR_0",
                         .component = GlbAttribute::Component::kUnsignedShort,
                         .normalised = true,
                         .count = 4,
                         .stride = 4 * sizeof(std::uint16_t)};
  attribute.bytes.reserve(colours.size() * attribute.stride);
  for (const auto& [red, green, blue] : colours) {
    append_value(attribute.bytes, std::array<std::uint16_t, 4>{of_channel[red], of_channel[green], of_channel[blue], alpha});
  }
  return attribute;
}

}  // namespace curvecast::formats
