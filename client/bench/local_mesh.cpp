#include "client/bench/local_mesh.h"

#include <cstdint>
#include <utility>

#include "client/lib/companion_files.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli::bench {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{16} << 30;

}  // namespace

absl::StatusOr<LocalMesh> LocalMesh::read(const std::string& path) {
  absl::StatusOr<std::string> bytes = client::read_bytes(path, kMaxFileBytes);
  if (!bytes.ok()) return bytes.status();
  return LocalMesh(path, *std::move(bytes));
}

MeshFile LocalMesh::file(std::string_view name) {
  return {name, bytes_, [this](std::string_view wanted) { return companion(wanted); }};
}

std::optional<std::span<const char>> LocalMesh::companion(std::string_view name) {
  const absl::StatusOr<client::InputFile> file = client::open_companion(path_, name);
  if (!file.ok() || file->size() > kMaxFileBytes) return std::nullopt;
  std::string& bytes = companions_.emplace_back(file->size(), '\0');
  if (!file->read_at(0, bytes).ok()) return std::nullopt;
  return bytes;
}

}  // namespace curvecast::cli::bench
