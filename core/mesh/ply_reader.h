// Reads the polygons of a PLY file: text, little or big endian.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "core/execution_context.h"
#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// Takes x, y, z of the element `vertex` and the list `vertex_indices` (or `vertex_index`) of the elements `face` and
/// `tristrips`; all else is skipped. Errors as for read_mesh, starting with the line (text) or the element's number from 0
/// (binary); a result without polygons is left to the caller.
absl::StatusOr<PolygonSoup> read_ply(std::string_view bytes, const ExecutionContext& context);

}  // namespace curvecast
