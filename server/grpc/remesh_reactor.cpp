// Remesh: makes a triangle mesh of a session's points, and sends it chunk by chunk.
#include "server/convert/convert.h"
#include "server/convert/mesh_chunks.h"
#include "server/frame/session_mesh.h"
#include "server/grpc/held_session.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"
#include "server/session/expected_time.h"

namespace curvecast::server {
namespace {

// The job is the only one that finishes, so the reactor outlives it. It queues with the preprocessing jobs: it may take seconds.
class RemeshReactor final : public WriteQueue<v1::RemeshResponse> {
 public:
  RemeshReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, const v1::RemeshRequest& request)
      : WriteQueue("Remesh", engine, context, caller) {
    begin_with([&] { return begin(engine, request); });
  }

 private:
  absl::Status begin(Engine& engine, const v1::RemeshRequest& request) {
    auto held = HeldSession::hold(engine, request.session_id(), caller());
    if (!held.ok()) return held.status();
    auto points = to_point_set_request(request.sample());
    if (!points.ok()) return points.status();
    if (points->automatic || points->max_bytes > 0) {
      return absl::InvalidArgumentError("sample has a budget that meshes cannot keep; ask for points or an error in pixels");
    }
    const auto options = to_remesh_options(request);
    if (!options.ok()) return options.status();
    const auto expected = expected_remesh_time(points->options.points);
    return engine.preprocessing
        .submit(
            [this, &engine, held = *std::move(held), points = *std::move(points), options = *options]() mutable {
              finish(held.answer(engine, [&](const std::shared_ptr<const Session>& session) {
                return answer(engine, *session, points, options);
              }));
            },
            claim(expected))
        .status();
  }

  absl::Status answer(Engine& engine, const Session& session, const PointSetRequest& points, const RemeshOptions& options) {
    if (cancelled()) return absl::CancelledError("the client has gone");
    MemoryBudget::Job memory(engine.memory, &cancel_flag());
    ExecutionContext context;
    context.cancel = &cancel_flag();
    context.memory = &memory;
    context.threads = engine.threads;
    context.on_progress = [this](std::string_view stage, double fraction) { push_progress(stage, fraction); };
    const absl::StatusOr<SessionMesh> mesh = make_session_mesh(session, points, options, engine.view_cache, context);
    if (!mesh.ok()) return mesh.status();
    return push_all([&](const auto& push_chunk) { return make_mesh_chunks(*mesh, *session.curve(), push_chunk); });
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::RemeshResponse>* remesh(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                                     const v1::RemeshRequest& request) {
  return new RemeshReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
