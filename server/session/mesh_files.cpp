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

absl::Status of_companion(const std::string& name, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat("companion \"", printable(name), "\": ", status.message()));
}

}  // namespace

absl::StatusOr<MeshFile> MeshFiles::file(const ExecutionContext& context) const {
  if (absl::Status opened = mesh->open(context); !opened.ok()) return opened;
  for (const auto& [name, file] : companions) {
    if (absl::Status opened = file->open(context); !opened.ok()) return of_companion(name, opened);
  }
  return MeshFile{mesh->name, mesh->bytes(), [this](std::string_view name) -> std::optional<std::span<const char>> {
                    const auto found = companions.find(std::string(name));
                    if (found == companions.end()) return std::nullopt;
                    return found->second->bytes();
                  }};
}

absl::Status MeshFiles::status() const {
  absl::Status status = mesh->status();
  for (const auto& [name, file] : companions) {
    if (!file->status().ok()) status.Update(of_companion(name, file->status()));
  }
  return status;
}

void MeshFiles::release_pages() const {
  mesh->release_pages();
  for (const auto& [name, file] : companions) file->release_pages();
}

absl::StatusOr<LoadedMesh> load_mesh(const MeshFiles& files, const ExecutionContext& context) {
  const absl::StatusOr<MeshFile> file = files.file(context);
  if (!file.ok()) return file.status();
  absl::StatusOr<LoadedMesh> mesh = curvecast::load_mesh(*file, context);
  if (absl::Status status = files.status(); !status.ok()) return status;
  return mesh;
}

absl::StatusOr<MeshFiles> find_files(MeshStore& store, const std::string& mesh_id,
                                     const google::protobuf::Map<std::string, std::string>& companions, const std::string& who) {
  if (companions.size() > kMaxCompanions) {
    return absl::InvalidArgumentError(
        absl::StrCat("companions has ", companions.size(), " entries; at most ", kMaxCompanions, " are taken"));
  }
  MeshFiles files;
  absl::StatusOr<std::shared_ptr<const Mesh>> mesh = store.find(mesh_id, who);
  if (!mesh.ok()) return mesh.status();
  files.mesh = *std::move(mesh);
  for (const auto& [name, id] : companions) {
    if (name.size() > kMaxName) {
      return absl::InvalidArgumentError(
          absl::StrCat("a name in companions has ", name.size(), " bytes; at most ", kMaxName, " are taken"));
    }
    absl::StatusOr<std::shared_ptr<const Mesh>> companion = store.find(id, who);
    if (!companion.ok()) {
      return of_companion(name, companion.status());
    }
    files.companions.emplace(name, *std::move(companion));
  }
  return files;
}

}  // namespace curvecast::server
