// Reads an STL file (stereolithography), binary or text.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// Tells whether the size fits the triangle count at byte 80: a binary file, even one that begins with "solid".
bool is_binary_stl(std::string_view bytes);

/// Reads an STL. Every facet gets vertices of its own (shares_vertices is false); normals and attribute bytes are ignored. Errors
/// as for read_mesh, starting with the line (text) or the triangle's number from 0 (binary); a result without polygons is left to
/// the caller.
absl::StatusOr<PolygonSoup> read_stl(std::string_view bytes, const ExecutionContext& context);

}  // namespace curvecast
