// The JSON of a glTF file as a tree, within limits.
#pragma once

#include <absl/status/statusor.h>

#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace curvecast {

/// A later parser takes up to a kilobyte for an object, however short: 256 MiB in all.
inline constexpr int kMostGltfObjects = 250'000;

/// Values under keys that say nothing about a mesh's shape and looks (extras, animations, skins ...) are left out. Takes linear
/// time. InvalidArgument, with the line, when the text is malformed, nested too deep (later parsers recurse), of too many objects
/// or values, or no object.
absl::StatusOr<nlohmann::json> parse_gltf_json(std::string_view text);

}  // namespace curvecast
