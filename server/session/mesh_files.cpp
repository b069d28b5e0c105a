#include "server/session/mesh_files.h"

#include <absl/strings/str_cat.h>

#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "core/mesh_io/mesh_companions.h"
#include "server/base/log.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxName = 1024;  // bytes

}  // namespace

MeshFile MeshFiles::file() const {
  return {mesh->name, mesh->bytes(), [this](std::string_view name) -> std::optional<std::span<const char>> {
            const auto found = companions.find(std::string(name));
            if (found == companions.end()) return std::nullopt;
            return found->second->bytes();
          }};
}

void MeshFiles::release_pages() const {
  mesh->data.release_pages();
  for (const auto& [name, file] : companions) file->data.release_pages();
}

absl::StatusOr<MeshFiles> find_files(MeshStore& store, const std::string& mesh_id,
                                     const google::protobuf::Map<std::string, std::string>& companions) {
  if (companions.size() > kMaxCompanions) {
    return absl::InvalidArgumentError(
        absl::StrCat("companions has ", companions.size(), " entries; at most ", kMaxCompanions, " are taken"));
  }
  MeshFiles files;
  absl::StatusOr<std::shared_ptr<const Mesh>> mesh = store.find(mesh_id);
  if (!mesh.ok()) return mesh.status();
  files.mesh = *std::move(mesh);
  for (const auto& [name, id] : companions) {
    if (name.size() > kMaxName) {
      return absl::InvalidArgumentError(
          absl::StrCat("a name in companions has ", name.size(), " bytes; at most ", kMaxName, " are taken"));
    }
    absl::StatusOr<std::shared_ptr<const Mesh>> companion = store.find(id);
    if (!companion.ok()) {
      return absl::Status(companion.status().code(),
                          absl::StrCat("companion \"", printable(name), "\": ", companion.status().message()));
    }
    files.companions.emplace(name, *std::move(companion));
  }
  return files;
}

}  // namespace curvecast::server
