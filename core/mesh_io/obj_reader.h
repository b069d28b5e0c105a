// Reads the polygons of a Wavefront OBJ file.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Takes `v` with colours, `vt`, `f`, `usemtl` and `mtllib`, and from `vn` and `s` which edges are sharp; every other keyword is
/// ignored, and all objects and groups are joined.
/// Errors as for read_mesh, starting with the line; a result without polygons is left to the caller.
absl::StatusOr<PolygonSoup> read_obj(const MeshFile& file, const ExecutionContext& context);

}  // namespace curvecast
