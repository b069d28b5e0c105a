// Buffer views of a glTF that EXT_meshopt_compression compresses.
// Source: A. Kapoulkine, EXT_meshopt_compression, Khronos Group, 2021.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh_io/gltf/gltf_model.h"

namespace curvecast {

/// Returns the bytes of `count` elements of `stride` each. InvalidArgument, before memory is taken for them, when mode, filter,
/// stride and count do not fit together or when `bytes`, the compressed ones, cannot hold so many; also when they are broken.
absl::StatusOr<std::vector<char>> decode_meshopt(const GltfMeshopt& view, std::span<const char> bytes);

/// Returns how many bytes decoding gives at most; 0 where it is refused because of what the view says.
std::uint64_t most_meshopt_bytes(const GltfMeshopt& view);

}  // namespace curvecast
