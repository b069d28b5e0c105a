// Reads the build of a 3MF file (3D Manufacturing Format).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Returns how many bytes the model parts of a 3MF claim to unpack to, as reading holds them to; 0 for what is no 3MF.
std::uint64_t three_mf_unpacked_bytes(std::span<const char> bytes);

/// Reads all that the build's items place, in the file's own units: meshes and components, with base materials, and colour groups
/// as colours of faces (the mean of a triangle's three). Other properties, beams and slices are left out with a warning.
/// Errors as for read_mesh, naming the part and its line ("3D/3dmodel.model: line 12: ...") or the object.
absl::StatusOr<PolygonSoup> read_three_mf(const MeshFile& file, const ExecutionContext& context);

}  // namespace curvecast
