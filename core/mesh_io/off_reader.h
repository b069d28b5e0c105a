// Reads an OFF file (Geomview's object file format), text only.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// Tells whether a word is the keyword of an OFF file: OFF, COFF, NOFF, STOFF, 4OFF, nOFF and their mixtures.
bool is_off_keyword(std::string_view word);

/// Takes what the keyword promises (normals, colours, texture coordinates, in this order behind the coordinates) and the faces'
/// colours; the fourth coordinate of 4OFF divides the others. Colours are 0 .. 1 unless one is larger, then 0 .. 255. Errors as
/// for read_mesh, starting with the line; a result without polygons is left to the caller.
absl::StatusOr<PolygonSoup> read_off(std::string_view text, const ExecutionContext& context);

}  // namespace curvecast
