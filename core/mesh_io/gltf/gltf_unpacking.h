// How much memory the compressed parts of a glTF take once they are decoded, told before they are.
#pragma once

#include <cstdint>
#include <string_view>

namespace curvecast {

/// Returns about how many bytes reading a glTF takes at most besides those in proportion to the file, from the counts in its
/// JSON: for Draco and meshopt data, for quantised vertices, and for the polygons that come of both. Counts that the reader
/// refuses stand for no more than it allows. 0 for other files and for what is no glTF.
std::uint64_t gltf_unpacking_bytes(std::string_view bytes);

}  // namespace curvecast
