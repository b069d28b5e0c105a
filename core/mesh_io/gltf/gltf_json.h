// The JSON of a glTF file as a tree, within limits.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace curvecast {

/// Builds the tree. Values under keys that say nothing about a mesh's shape and looks (extras, animations, skins ...) are left
/// out. Takes linear time. InvalidArgument, with the line, when the text is malformed, nested too deep, of too many values (the
/// tree takes up to 160 bytes for each), or no object.
absl::StatusOr<nlohmann::json> parse_gltf_json(std::string_view text);

/// Returns the member of an object; null where there is none, or no object.
const nlohmann::json* gltf_member(const nlohmann::json& object, const char* key);

/// Returns the string that a member is; empty where it is none.
std::string gltf_string(const nlohmann::json& object, const char* key);

/// Returns the whole number that a member is; -1 where it is none.
std::int64_t gltf_number(const nlohmann::json& object, const char* key);

}  // namespace curvecast
