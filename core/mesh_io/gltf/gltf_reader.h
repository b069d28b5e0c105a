// Reads the meshes of a glTF 2.0 scene, as JSON or GLB.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Reads the triangles, strips and fans of all meshes under the default scene's nodes (without one, under all root nodes; without
/// nodes, all meshes) in world coordinates, with NORMAL, COLOR_0, the texture coordinates of the base colour's texture, and the
/// materials' base colours. Points, lines, morph targets and skins are ignored. Vertices are to be welded: shares_vertices is
/// false. Errors as for read_mesh, naming node, mesh, primitive and accessor.
absl::StatusOr<PolygonSoup> read_gltf(const MeshFile& file, const ExecutionContext& context);

}  // namespace curvecast
