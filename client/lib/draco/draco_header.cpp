// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/draco_header.h"

#include <absl/strings/str_cat.h>
#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/config/compression_shared.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/draco_types.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>

namespace curvecast::client {
namespace {

constexpr std::uint64_t kPointsPerByte = 256;  // 70 were measured, for 4,000,000 points at 1 bit and normals at 2
constexpr std::uint64_t kFreePoints = 65'536;
constexpr std::uint64_t kMaxBytesPerPoint = 64;

static_assert(static_cast<int>(DracoKind::kPosition) == draco::GeometryAttribute::POSITION &&
              static_cast<int>(DracoKind::kNormal) == draco::GeometryAttribute::NORMAL &&
              static_cast<int>(DracoKind::kColour) == draco::GeometryAttribute::COLOR &&
              static_cast<int>(DracoKind::kGeneric) == draco::GeometryAttribute::GENERIC);
static_assert(kDracoUint8 == draco::DT_UINT8 && kDracoFloat == draco::DT_FLOAT32);

/// Adds up the attribute descriptions, which Draco writes the same way for its sequential and its kd-tree method.
absl::Status read_attributes(draco::DecoderBuffer* buffer, DracoHeaderInfo* info) {
  std::uint8_t groups = 0;
  std::uint32_t attributes = 0;
  if (!buffer->Decode(&groups) || !draco::DecodeVarint(&attributes, buffer)) return broken_draco("it ends within its header");
  if (groups != 1) return broken_draco(absl::StrCat("it has ", groups, " groups of attributes where point clouds have one"));
  for (std::uint32_t a = 0; a < attributes; ++a) {
    std::uint8_t kind = 0, type = 0, components = 0, normalised = 0;
    std::uint32_t id = 0;
    if (!buffer->Decode(&kind) || !buffer->Decode(&type) || !buffer->Decode(&components) || !buffer->Decode(&normalised) ||
        !draco::DecodeVarint(&id, buffer)) {
      return broken_draco("it ends within its attributes");
    }
    info->attributes.push_back({static_cast<DracoKind>(kind), type, components});
    const int size = draco::DataTypeLength(static_cast<draco::DataType>(type));
    if (size <= 0 || components == 0)
      return broken_draco(absl::StrCat("attribute ", a, " is ", components, " of data type ", type));
    info->bytes_per_point += static_cast<std::uint64_t>(size) * components;
    if (info->bytes_per_point > kMaxBytesPerPoint) return broken_draco("its attributes need more than 64 bytes per point");
  }
  return absl::OkStatus();
}

/// Not valid where a file's numbers are no floats.
RadiusRange to_range(double min, double max) {
  const double limit = std::numeric_limits<float>::max();
  if (!(min > 0 && min <= max && max <= limit)) return {};
  return {static_cast<float>(min), static_cast<float>(max)};
}

absl::StatusOr<DracoHeaderInfo> parse_header(std::string_view bytes, std::uint64_t max_points) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  std::array<char, 5> magic{};
  std::uint8_t major = 0, minor = 0, geometry = 0, method = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(&magic) || std::string_view(magic.data(), magic.size()) != "DRACO")
    return broken_draco("it does not begin with DRACO");
  if (!buffer.Decode(&major) || !buffer.Decode(&minor) || !buffer.Decode(&geometry) || !buffer.Decode(&method) ||
      !buffer.Decode(&flags)) {
    return broken_draco("it ends within its header");
  }
  if (major != draco::kDracoPointCloudBitstreamVersionMajor || minor > draco::kDracoPointCloudBitstreamVersionMinor) {
    return broken_draco(absl::StrCat("its version is ", major, ".", minor, "; 2.0 to 2.3 are supported"));
  }
  if (geometry != draco::POINT_CLOUD) return broken_draco("it holds no point cloud (a mesh, perhaps)");
  if (method > draco::POINT_CLOUD_KD_TREE_ENCODING) return broken_draco(absl::StrCat("its encoding method is ", method));
  buffer.set_bitstream_version(static_cast<std::uint16_t>(major << 8 | minor));

  DracoHeaderInfo info;
  info.sequential = method == draco::POINT_CLOUD_SEQUENTIAL_ENCODING;
  if ((flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    draco::MetadataDecoder decoder;
    if (!decoder.DecodeGeometryMetadata(&buffer, &metadata)) return broken_draco("its metadata cannot be read");
    double min = 0, max = 0;
    if (metadata.GetEntryDouble(kRadiusMinEntry, &min) && metadata.GetEntryDouble(kRadiusMaxEntry, &max)) {
      info.radii = to_range(min, max);
    }
  }
  std::int32_t points = 0;
  if (!buffer.Decode(&points)) return broken_draco("it ends within its header");
  if (points <= 0) return broken_draco(absl::StrCat("it claims ", points, " points"));
  info.points = static_cast<std::uint64_t>(points);
  const std::uint64_t possible = std::min(max_points, kPointsPerByte * bytes.size() + kFreePoints);
  if (info.points > possible) {
    return broken_draco(
        absl::StrCat("it claims ", info.points, " points in ", bytes.size(), " bytes; at most ", possible, " are accepted"));
  }
  if (absl::Status status = read_attributes(&buffer, &info); !status.ok()) {
    return status;
  }
  info.size = static_cast<std::size_t>(buffer.decoded_size());
  return info;
}

}  // namespace

const DracoAttribute* DracoHeaderInfo::find(DracoKind kind) const {
  const auto found = std::find_if(attributes.begin(), attributes.end(), [&](const auto& a) { return a.kind == kind; });
  return found == attributes.end() ? nullptr : &*found;
}

bool DracoHeaderInfo::has_colours() const {
  const DracoAttribute* colour = find(DracoKind::kColour);
  return colour != nullptr && colour->type == kDracoUint8 && (colour->components == 3 || colour->components == 4);
}

std::array<float, 256> radius_table(RadiusRange range) {
  std::array<float, 256> table;
  const double ratio = static_cast<double>(range.max) / static_cast<double>(range.min);
  for (int code = 0; code < 256; ++code) table[code] = static_cast<float>(range.min * std::pow(ratio, code / 255.0));
  return table;
}

absl::StatusOr<DracoHeaderInfo> check_draco_header(std::string_view bytes, std::uint64_t max_points) {
  try {
    return parse_header(bytes, max_points);
  } catch (const std::exception& error) {
    return broken_draco(error.what());
  }
}

absl::Status broken_draco(absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat("broken Draco data: ", what));
}

}  // namespace curvecast::client
