// Reads an OFF file (Geomview's object file format), text only.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "core/execution_context.h"
#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// True for the keyword of an OFF file: OFF, COFF, NOFF, STOFF, 4OFF, nOFF and their mixtures.
bool is_off_keyword(std::string_view word);

/// Normals, colours and texture coordinates are ignored; the fourth coordinate of 4OFF divides the others. Errors as for
/// read_mesh, starting with the line; a result without polygons is left to the caller.
absl::StatusOr<PolygonSoup> read_off(std::string_view text, const ExecutionContext& context);

}  // namespace curvecast
