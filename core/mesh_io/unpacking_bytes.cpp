#include "core/mesh_io/unpacking_bytes.h"

#include "core/mesh_io/gltf/gltf_unpacking.h"
#include "core/mesh_io/mesh_io.h"
#include "core/mesh_io/three_mf/three_mf_reader.h"

namespace curvecast {
namespace {

// The shortest vertex of a model part, of 27 bytes, takes up to 48 in a model that grows and 24 in a soup; triangles take less.
constexpr std::uint64_t kPerModelByte = 3;

}  // namespace

std::uint64_t unpacking_bytes(const MeshFile& file) {
  const absl::StatusOr<MeshFormat> format = detect_mesh_format(file.name, file.bytes);
  if (!format.ok()) return 0;
  if (*format == MeshFormat::kGltf) return gltf_unpacking_bytes(file.text());
  return *format == MeshFormat::kThreeMf ? kPerModelByte * three_mf_unpacked_bytes(file.bytes) : 0;
}

}  // namespace curvecast
