// A mesh file with the files that it refers to, taken from the store.
#pragma once

#include <absl/status/statusor.h>
#include <google/protobuf/map.h>

#include <map>
#include <memory>
#include <string>

#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"
#include "core/pipeline/pipeline.h"
#include "server/session/mesh_store.h"

namespace curvecast::server {

/// A mesh and its companions. Keeps all of them alive and in the store.
struct MeshFiles {
  std::shared_ptr<const Mesh> mesh;
  std::map<std::string, std::shared_ptr<const Mesh>> companions;  // by the name that the mesh gives them

  /// The files as core takes them; valid as long as this. Brings their bytes in, see Mesh::open(), and its errors: for workers.
  absl::StatusOr<MeshFile> file(const ExecutionContext& context = {}) const;
  /// As of Mesh::status(), of all of them.
  absl::Status status() const;
  /// Once they have been read: see MeshBytes::release_pages().
  void release_pages() const;
};

/// Reads and repairs the mesh: see curvecast::load_mesh(). Errors of file(), status() and of that. For workers.
absl::StatusOr<LoadedMesh> load_mesh(const MeshFiles& files, const ExecutionContext& context);

/// Looks all files up that `who` may find: see MeshStore::find(). Names are only compared with those in the mesh, never with any
/// file system. NotFound names the file that has to be uploaded (again); InvalidArgument for too many companions or names too
/// long.
absl::StatusOr<MeshFiles> find_files(MeshStore& store, const std::string& mesh_id,
                                     const google::protobuf::Map<std::string, std::string>& companions, const std::string& who);

}  // namespace curvecast::server
