// How much memory a compressed mesh file takes once it is unpacked, told before it is read.
#pragma once

#include <cstdint>

#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

/// Returns about how many bytes read_mesh() takes at most besides those in proportion to the file's own size: what is compressed
/// in a glTF, by the counts in its JSON, and the model parts of a 3MF, by its directory. Reading holds the file to both. 0 for
/// all else. Textures are not counted: see TextureLoader::kMostPixels.
std::uint64_t unpacking_bytes(const MeshFile& file);

}  // namespace curvecast
