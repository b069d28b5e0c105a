// Scatter: reads and repairs a mesh, places points on it, and sends them block by block.
#include "core/base/work_limit.h"
#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"
#include "server/convert/scatter_request.h"
#include "server/frame/scattered_blocks.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"
#include "server/session/expected_time.h"
#include "server/session/mesh_files.h"

namespace curvecast::server {
namespace {

/// What densities and moves of one call may take of all processors together.
constexpr WorkLimit::Nanoseconds kMostWork = std::chrono::minutes(1);

// The job is the only one that finishes, so the reactor outlives it. It queues with the preprocessing jobs: it reads a mesh.
class ScatterReactor final : public WriteQueue<v1::ScatterResponse> {
 public:
  ScatterReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, const v1::ScatterRequest& request)
      : WriteQueue("Scatter", engine, context, caller) {
    begin_with_meshes(engine, [this, &engine, &request] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::ScatterRequest& request) {
    auto files = find_files(engine.meshes, request.mesh_id(), request.companions(), caller().owner);
    if (!files.ok()) return files.status();
    const std::optional<double> degrees = request.has_crease_degrees() ? std::optional(request.crease_degrees()) : std::nullopt;
    auto wanted = to_scatter_request(request.sample(), degrees);
    if (!wanted.ok()) return wanted.status();
    const auto expected = expected_scatter_time(files->mesh->size(), wanted->scatter);
    push_progress("queued", 0);
    return engine.preprocessing
        .submit(
            [this, &engine, files = *std::move(files), wanted = *std::move(wanted)] {
              finish(to_grpc(status_from_exceptions([&] { return answer(engine, files, wanted); })));
            },
            claim(expected))
        .status();
  }

  absl::Status answer(Engine& engine, const MeshFiles& files, const ScatterRequest& wanted) {
    if (cancelled()) return absl::CancelledError("the client has gone");
    MemoryBudget::Job memory(engine.memory, &cancel_flag());
    WorkLimit limit(kMostWork);
    ExecutionContext context;
    context.cancel = &cancel_flag();
    context.limit = &limit;
    context.memory = &memory;
    context.threads = engine.threads;
    context.on_progress = [this](std::string_view stage, double fraction) { push_progress(stage, fraction); };
    const auto mesh = load_mesh(files, context);
    if (!mesh.ok()) return mesh.status();
    v1::ScatterResponse info;
    *info.mutable_mesh() = to_proto(mesh->info, files.mesh->name);
    push(std::move(info));
    return push_all([&](const auto& push_message) {
      return make_scattered_blocks(*mesh, wanted, context, [&](v1::ResampleResponse points) {
        if (points.has_statistics()) engine.metrics.stages(points.statistics());
        v1::ScatterResponse response;
        *response.mutable_points() = std::move(points);
        return push_message(std::move(response));
      });
    });
  }

  bool replaces(const v1::ScatterResponse& newer, const v1::ScatterResponse& older) const override {
    return newer.has_progress() && older.has_progress();
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::ScatterResponse>* scatter(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                                       const v1::ScatterRequest& request) {
  return new ScatterReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
