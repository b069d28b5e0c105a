// Remesh: makes a triangle mesh of a session's points, and sends it chunk by chunk.
#include <absl/strings/str_format.h>

#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"
#include "server/convert/field_validator.h"
#include "server/convert/mesh_chunks.h"
#include "server/engine/caller.h"
#include "server/frame/session_mesh.h"
#include "server/grpc/held_session.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"

namespace curvecast::server {
namespace {

RemeshMethod to_remesh_method(FieldValidator& check, v1::RemeshMethod method) {
  switch (method) {
    case v1::REMESH_METHOD_UNSPECIFIED:
    case v1::REMESH_METHOD_SURFACE:
      return RemeshMethod::kSurface;
    case v1::REMESH_METHOD_PARAMETER:
      return RemeshMethod::kParameter;
    default:
      check.fail("method", absl::StrFormat("is %d; there is no such method", static_cast<int>(method)));
  }
  return RemeshMethod::kSurface;
}

// The job is the only one that finishes, so the reactor outlives it. It queues with the preprocessing jobs: it may take seconds.
class RemeshReactor final : public WriteQueue<v1::RemeshResponse> {
 public:
  RemeshReactor(Engine& engine, grpc::CallbackServerContext& context, const v1::RemeshRequest& request)
      : WriteQueue(RequestLog(engine, "Remesh", context), engine.queued) {
    const absl::Status begun = status_from_exceptions([&] { return begin(engine, request, peer_of(context)); });
    if (!begun.ok()) finish(to_grpc(begun));
  }

 private:
  absl::Status begin(Engine& engine, const v1::RemeshRequest& request, const std::string& connection) {
    auto held = HeldSession::hold(engine, request.session_id());
    if (!held.ok()) return held.status();
    auto points = to_point_set_request(request.sample());
    if (!points.ok()) return points.status();
    if (points->automatic || points->max_bytes > 0) {
      return absl::InvalidArgumentError("sample has a budget that meshes cannot keep; ask for points or an error in pixels");
    }
    FieldValidator check;
    RemeshOptions options;
    if (request.has_relaxations()) {
      options.relaxations = static_cast<int>(
          check.in_range("relaxations", request.relaxations(), std::uint32_t{0}, std::uint32_t{kMaxRelaxations}));
    }
    options.fit = request.fit();
    options.feature_degrees = check.in_range("feature_degrees", request.feature_degrees(), 0.0, 180.0);
    options.method = to_remesh_method(check, request.method());
    if (options.method == RemeshMethod::kParameter && options.feature_degrees > 0) {
      check.fail("feature_degrees",
                 absl::StrFormat("is %g; the parameter square's method keeps no features", options.feature_degrees));
    }
    if (!check.ok()) return check.status();
    return engine.preprocessing
        .submit(
            [this, &engine, held = *std::move(held), points = *std::move(points), options]() mutable {
              finish(to_grpc(status_from_exceptions([&]() -> absl::Status {
                const absl::StatusOr<std::shared_ptr<const Session>> session = held.take(engine);
                if (!session.ok()) return session.status();
                return answer(engine, **session, points, options);
              })));
            },
            connection)
        .status();
  }

  absl::Status answer(Engine& engine, const Session& session, const PointSetRequest& points, const RemeshOptions& options) {
    if (cancelled()) return absl::CancelledError("the client has gone");
    ExecutionContext context;
    context.cancel = &cancel_flag();
    context.threads = engine.threads;
    context.on_progress = [this](std::string_view stage, double fraction) {
      v1::RemeshResponse response;
      response.mutable_progress()->set_stage(std::string(stage));
      response.mutable_progress()->set_fraction(fraction);
      push(std::move(response));
    };
    const absl::StatusOr<SessionMesh> mesh = make_session_mesh(session, points, options, engine.view_cache, context);
    if (!mesh.ok()) return mesh.status();
    return push_all([&](const auto& push_chunk) { return make_mesh_chunks(*mesh, *session.curve(), push_chunk); });
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::RemeshResponse>* remesh(Engine& engine, grpc::CallbackServerContext& context,
                                                     const v1::RemeshRequest& request) {
  return new RemeshReactor(engine, context, request);
}

}  // namespace curvecast::server
