// A glTF file taken apart: its model, and where its bytes are.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh_io/gltf/gltf_model.h"

namespace curvecast {

/// Where the bytes of a buffer or image are: in one of the first four, or nowhere.
struct GltfSource {
  std::string data_uri;           // "data:...", whole
  std::string file;               // name as written, percent signs decoded
  std::int64_t buffer_view = -1;  // images only
  bool binary_chunk = false;      // buffers only: behind the JSON of a GLB
  std::uint64_t byte_length = 0;  // buffers only
  bool is_base_colour = false;    // images only: a material's base colour uses it
};

struct GltfDocument {
  GltfModel model;
  std::vector<GltfSource> buffers;
  std::vector<GltfSource> images;
  std::optional<std::span<const char>> binary_chunk;  // of a GLB
};

/// Tells whether the bytes are a GLB, or a JSON object that mentions "asset".
bool is_gltf(std::string_view bytes);

/// Takes a .gltf or .glb apart. InvalidArgument for what parse_gltf_json or read_gltf_model refuses, for another version than 2,
/// and when a GLB is truncated.
absl::StatusOr<GltfDocument> parse_gltf(std::string_view bytes);

/// Decodes the bytes in "data:TYPE;base64,...". InvalidArgument when they are not base64.
absl::StatusOr<std::string> decode_data_uri(std::string_view uri);

}  // namespace curvecast
