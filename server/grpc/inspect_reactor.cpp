// InspectMesh and ListMeshReferences: read a mesh on a worker.
#include "core/mesh_io/mesh_companions.h"
#include "server/convert/convert.h"
#include "server/grpc/reactors.h"
#include "server/grpc/unary_job.h"
#include "server/session/mesh_files.h"

namespace curvecast::server {

grpc::ServerUnaryReactor* inspect_mesh(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                       const v1::InspectMeshRequest& request, v1::InspectMeshResponse* response) {
  return new UnaryJob(engine, "InspectMesh", context, caller, [&]() -> absl::StatusOr<UnaryJob::Work> {
    return [&engine, &request, response, owner = caller.owner](const ExecutionContext& job) {
      const absl::StatusOr<MeshFiles> files = find_files(engine.meshes, request.mesh_id(), request.companions(), owner);
      if (!files.ok()) return files.status();
      const absl::StatusOr<MeshFile> file = files->file(job);
      if (!file.ok()) return file.status();
      const auto info = curvecast::inspect_mesh(*file, job);
      if (absl::Status status = files->status(); !status.ok()) return status;
      if (info.ok()) *response->mutable_mesh() = to_proto(*info, files->mesh->name);
      return info.status();
    };
  });
}

grpc::ServerUnaryReactor* list_mesh_references(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                               const v1::ListMeshReferencesRequest& request,
                                               v1::ListMeshReferencesResponse* response) {
  return new UnaryJob(engine, "ListMeshReferences", context, caller, [&]() -> absl::StatusOr<UnaryJob::Work> {
    return [&engine, &request, response, owner = caller.owner](const ExecutionContext& job) {
      const absl::StatusOr<MeshFiles> files = find_files(engine.meshes, request.mesh_id(), request.companions(), owner);
      if (!files.ok()) return files.status();
      const absl::StatusOr<MeshFile> file = files->file(job);
      if (!file.ok()) return file.status();
      const auto names = mesh_companions(*file);
      if (absl::Status status = files->status(); !status.ok()) return status;
      if (!names.ok()) return names.status();
      for (const std::string& name : *names) response->add_missing(name);
      return absl::OkStatus();
    };
  });
}

}  // namespace curvecast::server
