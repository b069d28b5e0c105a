// SPDX-License-Identifier: Apache-2.0
#include "client/lib/drc_mesh.h"

#include <absl/strings/str_cat.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <cstdint>
#include <exception>
#include <memory>
#include <vector>

namespace curvecast::client {
namespace {

/// Adds an attribute with one value for each vertex; returns its number.
template <typename T>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data,
                  const std::vector<std::array<T, 3>>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, 3, data, false, 3 * sizeof(T), 0);
  const auto count = static_cast<std::uint32_t>(values.size());
  const int id = mesh.AddAttribute(attribute, true, count);
  for (std::uint32_t v = 0; v < count; ++v) mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &values[v]);
  return id;
}

draco::Status encode(const Mesh& from, const DrcOptions& options, std::string& out) {
  const Points& vertices = from.vertices;
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(vertices.size()));
  std::vector<std::array<float, 3>> positions = vertices.positions;
  for (auto& p : positions) {
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = static_cast<float>(p[axis] + vertices.origin[axis]);
  }
  const int position = add_attribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, positions);
  int normal = -1;
  if (!vertices.normals.empty()) {
    normal = add_attribute(mesh, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, vertices.normals);
  }
  if (!vertices.colours.empty()) add_attribute(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8, vertices.colours);
  mesh.SetNumFaces(from.triangles.size());
  for (std::uint32_t f = 0; f < from.triangles.size(); ++f) {
    const auto& [a, b, c] = from.triangles[f];
    mesh.SetFace(draco::FaceIndex(f), {draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetAttributeQuantization(position, options.position_bits);
  if (normal >= 0) encoder.SetAttributeQuantization(normal, options.normal_bits);
  draco::EncoderBuffer buffer;
  draco::Status status = encoder.EncodeToBuffer(&buffer);
  out.assign(buffer.data(), buffer.size());
  return status;
}

}  // namespace

absl::StatusOr<std::string> make_drc_mesh(const Mesh& mesh, const DrcOptions& options) {
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("Draco writes no mesh without triangles");
  if (absl::Status status = check_drc_options(options); !status.ok()) return status;
  std::string bytes;
  draco::Status status;
  try {
    status = encode(mesh, options, bytes);
  } catch (const std::exception& e) {
    return absl::InternalError(absl::StrCat("Draco: ", e.what()));
  }
  if (!status.ok()) return absl::InternalError(absl::StrCat("Draco: ", status.error_msg_string()));
  return bytes;
}

}  // namespace curvecast::client
