// GetParameterMesh: reads, repairs and flattens a mesh, and sends its discs chunk by chunk.
#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"
#include "server/convert/parameter_mesh_chunks.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"
#include "server/session/expected_time.h"
#include "server/session/mesh_files.h"

namespace curvecast::server {
namespace {

// The job is the only one that finishes, so the reactor outlives it. It queues with the preprocessing jobs, whose work is the
// same.
class ParameterMeshReactor final : public WriteQueue<v1::GetParameterMeshResponse> {
 public:
  ParameterMeshReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                       const v1::GetParameterMeshRequest& request)
      : WriteQueue("GetParameterMesh", engine, context, caller) {
    begin_with_meshes(engine, [this, &engine, &request] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::GetParameterMeshRequest& request) {
    auto files = find_files(engine.meshes, request.mesh_id(), request.companions(), caller().owner);
    if (!files.ok()) return files.status();
    const auto parameteriser = to_parameteriser("parameteriser", request.parameteriser());
    if (!parameteriser.ok()) return parameteriser.status();
    FieldValidator check;
    const PreprocessOptions options{.parameteriser = *parameteriser,
                                    .chart_faces = to_chart_faces(check, "chart_faces", request.chart_faces())};
    if (!check.ok()) return check.status();
    const auto expected = expected_time(files->mesh->size(), options);
    return engine.preprocessing
        .submit([this, &engine, files = *std::move(files),
                 options] { finish(to_grpc(status_from_exceptions([&] { return answer(engine, files, options); }))); },
                claim(expected))
        .status();
  }

  absl::Status answer(Engine& engine, const MeshFiles& files, const PreprocessOptions& options) {
    MemoryBudget::Job memory(engine.memory, &cancel_flag());
    ExecutionContext context;
    context.cancel = &cancel_flag();
    context.memory = &memory;
    context.threads = engine.threads;
    const absl::StatusOr<MeshFile> file = files.file(context);
    if (!file.ok()) return file.status();
    const auto flattened = flatten_mesh(*file, options, context);
    if (absl::Status status = files.status(); !status.ok()) return status;
    if (!flattened.ok()) return flattened.status();
    return push_all([&](const auto& push_chunk) { return make_chunks(*flattened, files.mesh->name, push_chunk); });
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::GetParameterMeshResponse>* get_parameter_mesh(Engine& engine, grpc::CallbackServerContext& context,
                                                                           const Caller& caller,
                                                                           const v1::GetParameterMeshRequest& request) {
  return new ParameterMeshReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
