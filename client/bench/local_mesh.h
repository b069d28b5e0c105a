// A mesh file on this machine, read without a server, with the files beside it that it refers to.
#pragma once

#include <absl/status/statusor.h>

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

/// Not thread-safe; must outlive what file() returns.
class LocalMesh {
 public:
  /// Errors as of client::read_bytes.
  static absl::StatusOr<LocalMesh> read(const std::string& path);

  /// For core, under `name`. What it refers to is read when it is asked for, from the mesh's own folder only, and kept.
  MeshFile file(std::string_view name);

 private:
  LocalMesh(std::string path, std::string bytes) : path_(std::move(path)), bytes_(std::move(bytes)) {}
  std::optional<std::span<const char>> companion(std::string_view name);

  std::string path_;
  std::string bytes_;
  std::deque<std::string> companions_;
};

}  // namespace curvecast::cli::bench
