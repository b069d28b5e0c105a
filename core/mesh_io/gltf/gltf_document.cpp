#include "core/mesh_io/gltf/gltf_document.h"

#include <absl/strings/escaping.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/mesh_io/gltf/gltf_json.h"
#include "core/mesh_io/reading/endian.h"

namespace curvecast {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kMagic = "glTF";

/// The two chunks of a GLB.
struct Chunks {
  std::string_view json;
  std::optional<std::span<const char>> binary;
};

absl::StatusOr<Chunks> chunks_of_glb(std::string_view bytes) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const auto word = [&](std::size_t at) { return load<std::uint32_t, false>(bytes.data() + at); };
  if (bytes.size() < kHeader + kChunkHeader) return absl::InvalidArgumentError("the file ends within the header of a GLB");
  if (word(4) != 2) return absl::InvalidArgumentError(absl::StrFormat("GLB version %d is not supported, only 2", word(4)));
  if (word(8) > bytes.size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the file has %d bytes, but its header claims %d: it is truncated", bytes.size(), word(8)));
  }
  Chunks chunks;
  std::size_t at = kHeader;
  for (int i = 0; i < 2 && bytes.size() - at >= kChunkHeader; ++i) {
    const std::uint32_t length = word(at), type = word(at + 4);
    at += kChunkHeader;
    if (length > bytes.size() - at) {
      return absl::InvalidArgumentError(
          absl::StrFormat("chunk %d claims %d bytes, but only %d are left", i, length, bytes.size() - at));
    }
    if (i == 0 && type != kJson) return absl::InvalidArgumentError("the first chunk of the GLB is not JSON");
    if (i == 0) chunks.json = bytes.substr(at, length);
    if (i == 1 && type == kBinary) chunks.binary = std::span<const char>(bytes.data() + at, length);
    at = std::min(bytes.size(), at + length + (4 - length % 4) % 4);
  }
  return chunks;
}

std::string percent_decoded(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
  };
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escaped = text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0;
    decoded += escaped ? static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2])) : text[i];
    if (escaped) i += 2;
  }
  return decoded;
}

std::vector<GltfSource> take_sources(Json& document, const char* key) {
  std::vector<GltfSource> sources;
  const auto found = document.find(key);
  if (found == document.end() || !found->is_array()) return sources;
  for (Json& object : *found) {
    GltfSource source;
    std::string uri = gltf_string(object, "uri");
    source.buffer_view = gltf_number(object, "bufferView");
    source.byte_length = static_cast<std::uint64_t>(std::max<std::int64_t>(0, gltf_number(object, "byteLength")));
    const Json* const extensions = gltf_member(object, "extensions");
    const Json* const meshopt = extensions != nullptr ? gltf_member(*extensions, "EXT_meshopt_compression") : nullptr;
    const Json* const fallback = meshopt != nullptr ? gltf_member(*meshopt, "fallback") : nullptr;
    if (fallback != nullptr && fallback->is_boolean() && fallback->get<bool>()) uri.clear();  // not compressed: never read
    if (uri.starts_with("data:")) {
      source.data_uri = std::move(uri);
    } else if (!uri.empty()) {
      source.file = percent_decoded(uri);
    }
    object = Json();  // a data URI may be most of the file
    sources.push_back(std::move(source));
  }
  if (!sources.empty()) sources[0].binary_chunk = sources[0].data_uri.empty() && sources[0].file.empty();
  return sources;
}

void note_base_colours(const GltfModel& model, std::vector<GltfSource>& images) {
  for (const GltfMaterial& material : model.materials) {
    const std::int64_t texture = material.colour_texture != nullptr ? material.colour_texture->texture : -1;
    if (texture < 0 || texture >= static_cast<std::int64_t>(model.image_of_texture.size())) continue;
    const std::int64_t image = model.image_of_texture[static_cast<std::size_t>(texture)];
    if (image >= 0 && image < static_cast<std::int64_t>(images.size()))
      images[static_cast<std::size_t>(image)].is_base_colour = true;
  }
}

}  // namespace

bool is_gltf(std::string_view bytes) {
  if (bytes.starts_with(kMagic)) return true;
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && bytes[first] == '{' && bytes.find("\"asset\"") != std::string_view::npos;
}

absl::StatusOr<GltfDocument> parse_gltf(std::string_view bytes) {
  Chunks chunks{.json = bytes, .binary = std::nullopt};
  if (bytes.starts_with(kMagic)) {
    absl::StatusOr<Chunks> found = chunks_of_glb(bytes);
    if (!found.ok()) return found.status();
    chunks = *found;
  }
  absl::StatusOr<Json> json = parse_gltf_json(chunks.json);
  if (!json.ok()) return json.status();
  const Json* const asset = gltf_member(*json, "asset");
  const std::string version = asset != nullptr ? gltf_string(*asset, "version") : std::string();
  if (!version.starts_with("2.")) {
    return absl::InvalidArgumentError(
        absl::StrFormat("this is not glTF 2.0 (its asset has version '%s')", absl::CHexEscape(version)));
  }
  GltfDocument document;
  document.binary_chunk = chunks.binary;
  document.buffers = take_sources(*json, "buffers");
  document.images = take_sources(*json, "images");
  absl::StatusOr<GltfModel> model = read_gltf_model(*json);
  if (!model.ok()) return model.status();
  document.model = *std::move(model);
  note_base_colours(document.model, document.images);
  return document;
}

absl::StatusOr<std::string> decode_data_uri(std::string_view uri) {
  constexpr std::string_view kBase64 = ";base64,";
  const std::size_t at = uri.find(kBase64);
  std::string bytes;
  if (at == std::string_view::npos ||
      !absl::Base64Unescape({uri.data() + at + kBase64.size(), uri.size() - at - kBase64.size()}, &bytes)) {
    return absl::InvalidArgumentError("a data URI is not base64");
  }
  return bytes;
}

}  // namespace curvecast
