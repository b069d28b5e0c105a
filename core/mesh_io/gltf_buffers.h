// The bytes behind a glTF: out of the file itself, or of its companions.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "core/mesh_io/gltf_document.h"
#include "core/mesh_io/mesh_file.h"

namespace curvecast {

class GltfBuffers {
 public:
  /// Keeps references to both.
  GltfBuffers(const MeshFile& file, const GltfDocument& document) : file_(file), document_(document) {}

  /// The bytes of buffer `index`: as many as it claims. They live as long as this object. InvalidArgument when there is no such
  /// buffer, or not all of its bytes.
  absl::StatusOr<std::span<const char>> buffer(std::int64_t index);

  /// The part [offset, offset + length) of it.
  absl::StatusOr<std::span<const char>> slice(std::int64_t index, std::uint64_t offset, std::uint64_t length);

  /// Of all the buffers that were asked for so far.
  std::uint64_t bytes_used() const { return bytes_used_; }

 private:
  absl::StatusOr<std::span<const char>> find(std::int64_t index);

  const MeshFile& file_;
  const GltfDocument& document_;
  std::map<std::int64_t, std::span<const char>> known_;
  std::map<std::int64_t, std::string> decoded_;
  std::uint64_t bytes_used_ = 0;
};

}  // namespace curvecast
