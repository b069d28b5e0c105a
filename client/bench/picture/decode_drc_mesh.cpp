#include "client/bench/picture/decode_drc_mesh.h"

#include <draco/compression/decode.h>

#include <array>
#include <utility>

#include "core/mesh/repair.h"

namespace curvecast::cli::bench {

absl::StatusOr<LoadedMesh> decode_drc_mesh(std::string_view bytes, const Vec3d& origin) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return absl::DataLossError(decoded.status().error_msg_string());
  const draco::Mesh& mesh = *decoded.value();
  const draco::PointAttribute* const positions = mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  const draco::PointAttribute* const colours = mesh.GetNamedAttribute(draco::GeometryAttribute::COLOR);
  if (positions == nullptr) return absl::DataLossError("a Draco mesh without positions");
  PolygonSoup soup;
  for (std::uint32_t v = 0; v < mesh.num_points(); ++v) {
    std::array<double, 3> p{};
    positions->ConvertValue<double, 3>(positions->mapped_index(draco::PointIndex(v)), p.data());
    soup.positions.emplace_back(origin + Vec3d(p[0], p[1], p[2]));
    if (colours == nullptr) continue;
    std::array<std::uint8_t, 3> c{};
    colours->ConvertValue<std::uint8_t, 3>(colours->mapped_index(draco::PointIndex(v)), c.data());
    soup.attributes.colours.push_back({c[0], c[1], c[2], 255});
  }
  soup.polygon_begin.push_back(0);
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& v : mesh.face(draco::FaceIndex(f))) soup.indices.push_back(v.value());
    soup.polygon_begin.push_back(static_cast<std::uint32_t>(soup.indices.size()));
  }
  absl::StatusOr<RepairedMesh> repaired = repair(std::move(soup));
  if (!repaired.ok()) return repaired.status();
  return LoadedMesh{std::move(repaired->mesh), std::move(repaired->attributes), std::move(repaired->sources), {}};
}

}  // namespace curvecast::cli::bench
