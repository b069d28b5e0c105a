// SPDX-License-Identifier: Apache-2.0
#include "client/lib/drc_file.h"

#include <absl/strings/str_cat.h>
#include <draco/compression/expert_encode.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "client/lib/draco/draco_points.h"
#include "client/lib/file_bytes.h"
#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;

std::unique_ptr<draco::GeometryMetadata> radius_metadata(const RadiusRange& range) {
  auto metadata = std::make_unique<draco::GeometryMetadata>();
  metadata->AddEntryDouble(kRadiusMinEntry, range.min);
  metadata->AddEntryDouble(kRadiusMaxEntry, range.max);
  return metadata;
}

RadiusRange range_of(const std::vector<float>& radii) {
  // Zero has no logarithm; a radius that small is as good as none.
  const auto positive = [](float r) { return std::max(r, std::numeric_limits<float>::min()); };
  RadiusRange range{std::numeric_limits<float>::max(), 0};
  for (const float r : radii) range = {std::min(range.min, positive(r)), std::max(range.max, positive(r))};
  return range;
}

std::vector<std::uint8_t> encode_radii(const std::vector<float>& radii, const RadiusRange& range) {
  std::vector<std::uint8_t> codes(radii.size());
  const double log_min = std::log(static_cast<double>(range.min));
  const double width = std::log(static_cast<double>(range.max)) - log_min;
  const double scale = width > 0 ? 255 / width : 0;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const double log_r = std::log(static_cast<double>(std::max(radii[i], range.min)));
    codes[i] = static_cast<std::uint8_t>(std::clamp(std::lround((log_r - log_min) * scale), 0L, 255L));
  }
  return codes;
}

void make_absolute(Points* points) {
  for (auto& position : points->positions) {
    for (int axis = 0; axis < 3; ++axis) position[axis] = static_cast<float>(position[axis] + points->origin[axis]);
  }
  points->origin = {};
}

std::string encode(const Points& points, const DrcOptions& options, draco::Status* status) {
  draco::PointCloudBuilder builder;
  builder.Start(static_cast<std::uint32_t>(points.size()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  builder.SetAttributeValuesForAllPoints(position, points.positions.data(), 0);
  int normal = -1;
  if (!points.normals.empty()) {
    normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
    builder.SetAttributeValuesForAllPoints(normal, points.normals.data(), 0);
  }
  const RadiusRange range = range_of(points.radii);
  if (!points.radii.empty()) {
    const std::vector<std::uint8_t> codes = encode_radii(points.radii, range);
    const int radius = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT8);
    builder.SetAttributeValuesForAllPoints(radius, codes.data(), 0);
  }
  if (!points.colours.empty()) {
    const int colour = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
    builder.SetAttributeValuesForAllPoints(colour, points.colours.data(), 0);
  }
  const std::unique_ptr<draco::PointCloud> cloud = builder.Finalize(false);
  if (!points.radii.empty()) cloud->AddMetadata(radius_metadata(range));

  draco::ExpertEncoder encoder(*cloud);
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(position, options.position_bits);
  if (normal >= 0) encoder.SetAttributeQuantization(normal, options.normal_bits);
  draco::EncoderBuffer buffer;
  *status = encoder.EncodeToBuffer(&buffer);
  return {buffer.data(), buffer.size()};
}

}  // namespace

absl::Status check_drc_options(const DrcOptions& options) {
  const auto& [position_bits, normal_bits] = options;
  if (position_bits >= 1 && position_bits <= 30 && normal_bits >= 2 && normal_bits <= 30) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("position bits must be 1 to 30 and normal bits 2 to 30, not ", position_bits, " and ", normal_bits));
}

absl::StatusOr<std::string> make_drc(Points points, const DrcOptions& options) {
  if (points.size() == 0 || points.size() > kMaxPoints) {
    return absl::InvalidArgumentError(absl::StrCat("a .drc file takes 1 to ", kMaxPoints, " points, not ", points.size()));
  }
  if (absl::Status status = check_drc_options(options); !status.ok()) return status;
  make_absolute(&points);
  try {
    draco::Status status;
    std::string bytes = encode(points, options, &status);
    if (!status.ok()) return absl::InternalError(absl::StrCat("Draco cannot encode the points: ", status.error_msg_string()));
    return bytes;
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("Draco cannot encode the points: ", error.what()));
  }
}

absl::StatusOr<Points> parse_drc(std::string_view bytes) {
  absl::StatusOr<DracoHeaderInfo> header = check_draco_header(bytes, kMaxPoints);
  if (!header.ok()) return header.status();
  absl::StatusOr<DecodedPoints> decoded = decode_draco(bytes, *header, header->radii);
  if (!decoded.ok()) return decoded.status();
  Points points;
  points.positions = std::move(decoded->positions);
  points.normals = std::move(decoded->normals);
  points.radii = std::move(decoded->radii);
  points.colours = std::move(decoded->colours);
  return points;
}

absl::StatusOr<Points> read_drc(const std::string& path) {
  absl::StatusOr<std::string> bytes = read_bytes(path, kMaxFileBytes);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<Points> points = parse_drc(*bytes);
  if (!points.ok()) return absl::Status(points.status().code(), absl::StrCat(path, ": ", points.status().message()));
  return points;
}

}  // namespace curvecast::client
