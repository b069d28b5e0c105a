// The JSON of a glTF file, checked and cut down to what a mesh needs, before anything else parses it.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace curvecast {

/// Where the bytes of a buffer or image are: one of the four, or none.
struct GltfSource {
  std::string data_uri;           // "data:...", whole
  std::string file;               // name as written, percent signs decoded
  std::int64_t buffer_view = -1;  // images only
  bool binary_chunk = false;      // buffers only: behind the JSON of a GLB
  std::uint64_t byte_length = 0;  // buffers only
  bool is_base_colour = false;    // images only: a material's base colour uses it
};

struct GltfDocument {
  std::string json;  // asset, extensionsRequired, accessors, bufferViews, meshes, nodes, scenes, materials and textures only
  std::vector<GltfSource> buffers;
  std::vector<GltfSource> images;
  std::optional<std::span<const char>> binary_chunk;  // of a GLB
};

/// True for a GLB, and for a JSON object that mentions "asset".
bool is_gltf(std::string_view bytes);

/// Finds the JSON in a .gltf or .glb. InvalidArgument for what parse_gltf_json refuses, for more than 4,096 materials, offsets
/// and counts that are no counts, another version than 2, and when a GLB is truncated.
absl::StatusOr<GltfDocument> parse_gltf(std::string_view bytes);

/// The bytes in "data:TYPE;base64,...". InvalidArgument when they are not base64.
absl::StatusOr<std::string> decode_data_uri(std::string_view uri);

}  // namespace curvecast
