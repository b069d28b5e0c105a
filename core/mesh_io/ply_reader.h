// Reads the polygons of a PLY file: text, little or big endian.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Takes the scalars of the element `vertex` (see vertex_columns) and of the elements `face` and `tristrips` the list
/// `vertex_indices` (or `vertex_index`); of `face` also red, green, blue, alpha, the list `texcoord` (u and v of each corner) and
/// `texnumber`, which counts the header's lines `comment TextureFile NAME`. All else is skipped. Errors as for read_mesh,
/// starting with the line (text) or the element's number from 0 (binary); a result without polygons is left to the caller.
absl::StatusOr<PolygonSoup> read_ply(const MeshFile& file, const ExecutionContext& context);

}  // namespace curvecast
