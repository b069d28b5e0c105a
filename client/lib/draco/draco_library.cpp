// SPDX-License-Identifier: Apache-2.0
#include "client/lib/draco/draco_library.h"

#include <absl/strings/str_cat.h>
#include <draco/compression/decode.h>

#include <array>
#include <cstring>
#include <exception>

namespace curvecast::client {
namespace {

using Vec = std::array<float, 3>;

/// Copies an attribute of three numbers.
absl::Status copy_vectors(const draco::PointCloud& cloud, draco::GeometryAttribute::Type type, absl::string_view name,
                          std::span<Vec> values) {
  const draco::PointAttribute* attribute = cloud.GetNamedAttribute(type);
  if (attribute == nullptr) return broken_draco(absl::StrCat("it has no ", name, "s"));
  if (attribute->num_components() != 3) return broken_draco(absl::StrCat("its ", name, " attribute has not three components"));
  if (attribute->data_type() == draco::DT_FLOAT32 && attribute->is_mapping_identity() && attribute->byte_offset() == 0 &&
      attribute->byte_stride() == sizeof(Vec) && attribute->buffer()->data_size() >= values.size_bytes()) {
    std::memcpy(values.data(), attribute->buffer()->data(), values.size_bytes());
    return absl::OkStatus();
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= attribute->size() || !attribute->ConvertValue<float>(value, 3, values[i].data())) {
      return broken_draco(absl::StrCat("its ", name, " attribute cannot be read"));
    }
  }
  return absl::OkStatus();
}

absl::Status copy_radii(const draco::PointCloud& cloud, RadiusRange range, std::span<float> radii) {
  const draco::PointAttribute* attribute = cloud.GetNamedAttribute(draco::GeometryAttribute::GENERIC);
  if (attribute == nullptr || attribute->data_type() != draco::DT_UINT8 || attribute->num_components() != 1) {
    return broken_draco("its radius attribute is not one byte");
  }
  const std::array<float, 256> table = radius_table(range);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= attribute->size()) return broken_draco("its radius attribute is too short");
    radii[i] = table[*attribute->GetAddress(value)];
  }
  return absl::OkStatus();
}

absl::Status copy_colours(const draco::PointCloud& cloud, std::span<std::array<std::uint8_t, 3>> colours) {
  const draco::PointAttribute* attribute = cloud.GetNamedAttribute(draco::GeometryAttribute::COLOR);
  if (attribute == nullptr) return broken_draco("it has no colours");
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= attribute->size()) return broken_draco("its colour attribute is too short");
    std::memcpy(colours[i].data(), attribute->GetAddress(value), 3);
  }
  return absl::OkStatus();
}

absl::Status decode(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii, const PointColumns& to) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  const auto cloud = decoder.DecodePointCloudFromBuffer(&buffer);
  if (!cloud.ok()) return broken_draco(cloud.status().error_msg_string());
  const draco::PointCloud& points = *cloud.value();
  if (points.num_points() != header.points) return broken_draco("it holds another number of points than it claims");
  absl::Status status = copy_vectors(points, draco::GeometryAttribute::POSITION, "position", to.positions);
  if (status.ok() && !to.normals.empty()) {
    status = copy_vectors(points, draco::GeometryAttribute::NORMAL, "normal", to.normals);
  }
  if (status.ok() && !to.radii.empty()) status = copy_radii(points, radii, to.radii);
  if (status.ok() && !to.colours.empty()) status = copy_colours(points, to.colours);
  return status.ok() ? check_finite(to) : status;
}

}  // namespace

absl::Status decode_with_draco(std::string_view bytes, const DracoHeaderInfo& header, RadiusRange radii, const PointColumns& to) {
  try {
    return decode(bytes, header, radii, to);
  } catch (const std::exception& error) {
    return broken_draco(error.what());
  }
}

}  // namespace curvecast::client
