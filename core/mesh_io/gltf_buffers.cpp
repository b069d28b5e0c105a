#include "core/mesh_io/gltf_buffers.h"

#include <absl/strings/str_format.h>

#include <optional>
#include <utility>

#include "core/mesh_io/companion_name.h"

namespace curvecast {

absl::StatusOr<std::span<const char>> GltfBuffers::buffer(std::int64_t index) {
  if (const auto known = known_.find(index); known != known_.end()) return known->second;
  absl::StatusOr<std::span<const char>> bytes = find(index);
  if (!bytes.ok()) return bytes.status();
  const std::uint64_t claimed = document_.buffers[static_cast<std::size_t>(index)].byte_length;
  if (claimed > bytes->size()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("buffer %d claims %d bytes, but there are only %d: it is truncated", index, claimed, bytes->size()));
  }
  bytes_used_ += claimed;
  return known_[index] = bytes->first(claimed);
}

absl::StatusOr<std::span<const char>> GltfBuffers::slice(std::int64_t index, std::uint64_t offset, std::uint64_t length) {
  absl::StatusOr<std::span<const char>> bytes = buffer(index);
  if (!bytes.ok()) return bytes.status();
  if (offset > bytes->size() || length > bytes->size() - offset) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d bytes at %d reach beyond buffer %d, which has %d", length, offset, index, bytes->size()));
  }
  return bytes->subspan(offset, length);
}

absl::StatusOr<std::span<const char>> GltfBuffers::find(std::int64_t index) {
  if (index < 0 || index >= static_cast<std::int64_t>(document_.buffers.size())) {
    return absl::InvalidArgumentError(
        absl::StrFormat("there is no buffer %d (the file has %d)", index, document_.buffers.size()));
  }
  const GltfSource& source = document_.buffers[static_cast<std::size_t>(index)];
  if (!source.data_uri.empty()) {
    absl::StatusOr<std::string> decoded = decode_data_uri(source.data_uri);
    if (!decoded.ok()) return absl::InvalidArgumentError(absl::StrFormat("buffer %d: %s", index, decoded.status().message()));
    const std::string& kept = decoded_[index] = *std::move(decoded);
    return std::span<const char>(kept);
  }
  if (source.binary_chunk && document_.binary_chunk) return *document_.binary_chunk;
  if (source.file.empty()) return absl::InvalidArgumentError(absl::StrFormat("buffer %d has no bytes anywhere", index));
  const std::optional<std::string> name = safe_companion_name(source.file);
  const auto bytes = name && file_.companion ? file_.companion(*name) : std::nullopt;
  if (bytes) return *bytes;
  return absl::InvalidArgumentError(absl::StrFormat("buffer %d is in the file '%s', which is not there beside the mesh", index,
                                                    display_name(name ? *name : source.file)));
}

}  // namespace curvecast
