// InspectMesh: reads and repairs on a worker.
#include <atomic>

#include "server/convert.h"
#include "server/grpc_status.h"
#include "server/guarded.h"
#include "server/reactors.h"
#include "server/request_log.h"

namespace curvecast::server {
namespace {

// The job is the only one that finishes, so the reactor outlives it.
class InspectReactor final : public grpc::ServerUnaryReactor {
 public:
  InspectReactor(Engine& engine, const grpc::CallbackServerContext& context, const v1::InspectMeshRequest& request,
                 v1::InspectMeshResponse* response)
      : log_(*engine.log, "InspectMesh", context), response_(response) {
    const absl::Status begun = guarded([&] { return begin(engine, request.mesh_id()); });
    if (!begun.ok()) finish(begun);
  }

 private:
  void OnCancel() override { cancel_ = true; }
  void OnDone() override { delete this; }

  absl::Status begin(Engine& engine, const std::string& mesh_id) {
    auto mesh = engine.meshes.find(mesh_id);
    if (!mesh.ok()) return mesh.status();
    return engine.views.submit([this, mesh = *std::move(mesh)] { finish(inspect(*mesh)); }).status();
  }

  absl::Status inspect(const Mesh& mesh) {
    return guarded([&] {
      ExecutionContext context;
      context.cancel = &cancel_;
      context.threads = 1;
      const auto info = curvecast::inspect_mesh({mesh.name, mesh.bytes()}, context);
      if (info.ok()) *response_->mutable_mesh() = to_proto(*info, mesh.name);
      return info.status();
    });
  }

  void finish(const absl::Status& status) {
    log_.finish(to_grpc(status));
    Finish(to_grpc(status));
  }

  RequestLog log_;
  v1::InspectMeshResponse* const response_;
  std::atomic<bool> cancel_ = false;
};

}  // namespace

grpc::ServerUnaryReactor* inspect_mesh(Engine& engine, grpc::CallbackServerContext& context,
                                       const v1::InspectMeshRequest& request, v1::InspectMeshResponse* response) {
  return new InspectReactor(engine, context, request, response);
}

}  // namespace curvecast::server
