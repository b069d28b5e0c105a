// Reads a material library of Wavefront OBJ files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/colour.h"

namespace curvecast {

struct MtlMaterial {
  std::string_view name;     // points into the text
  Rgba8 colour;              // Kd, and d or Tr as alpha
  std::string_view texture;  // file name of map_Kd as written, without its options; empty: none
  std::size_t line = 0;      // of map_Kd, from 1
};

/// Returns the text without the blanks at both ends.
std::string_view trimmed(std::string_view text);

/// Finds the names behind `mtllib` in an OBJ: several, or one with blanks in it (names end in ".mtl", or with the line). Point
/// into `line`.
std::vector<std::string_view> library_names(std::string_view line);

/// Reads the materials in the file's order; whatever is malformed or of another kind is passed over.
std::vector<MtlMaterial> read_mtl(std::string_view text);

}  // namespace curvecast
