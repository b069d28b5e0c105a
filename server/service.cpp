#include "server/service.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "server/convert.h"
#include "server/grpc_status.h"
#include "server/guarded.h"
#include "server/import_mesh.h"
#include "server/log.h"
#include "server/reactors.h"
#include "server/request_log.h"
#include "server/unary_job.h"

namespace curvecast::server {
namespace {

constexpr std::uint32_t kPageSize = 100, kMostOnPage = 1000;

bool is_id(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// Answers on the spot.
template <class Answer>
grpc::ServerUnaryReactor* answer(Engine& engine, const char* method, grpc::CallbackServerContext* context, Answer&& work) {
  RequestLog log(*engine.log, method, *context);
  const grpc::Status status = to_grpc(guarded(work));
  log.finish(status);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(status);
  return reactor;
}

}  // namespace

v1::Session Service::with_cached(v1::Session session) const {
  session.set_cached(engine_.is_cached(session.session_id()));
  return session;
}

grpc::ServerReadReactor<v1::UploadMeshRequest>* Service::UploadMesh(grpc::CallbackServerContext* context,
                                                                    v1::UploadMeshResponse* response) {
  return upload_mesh(engine_, *context, response);
}

grpc::ServerUnaryReactor* Service::GetMesh(grpc::CallbackServerContext* context, const v1::GetMeshRequest* request,
                                           v1::GetMeshResponse* response) {
  return answer(engine_, "GetMesh", context, [&] {
    const auto mesh = engine_.meshes.find(request->mesh_id());
    if (!mesh.ok()) return mesh.status();
    response->set_mesh_id((*mesh)->id);
    response->set_name((*mesh)->name);
    response->set_size((*mesh)->size);
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* Service::GetUpload(grpc::CallbackServerContext* context, const v1::GetUploadRequest* request,
                                             v1::GetUploadResponse* response) {
  return answer(engine_, "GetUpload", context, [&] {
    response->set_received(engine_.meshes.received(request->mesh_id()));
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* Service::ImportMesh(grpc::CallbackServerContext* context, const v1::ImportMeshRequest* request,
                                              v1::ImportMeshResponse* response) {
  return new UnaryJob(engine_, "ImportMesh", *context, [&]() -> absl::StatusOr<UnaryJob::Work> {
    return [this, path = request->path(), response](const ExecutionContext& job) {
      const auto mesh = import_mesh(engine_.meshes, engine_.mesh_folder, path, job);
      if (!mesh.ok()) return mesh.status();
      response->set_mesh_id((*mesh)->id);
      response->set_size((*mesh)->size);
      return absl::OkStatus();
    };
  });
}

grpc::ServerUnaryReactor* Service::InspectMesh(grpc::CallbackServerContext* context, const v1::InspectMeshRequest* request,
                                               v1::InspectMeshResponse* response) {
  return inspect_mesh(engine_, *context, *request, response);
}

grpc::ServerUnaryReactor* Service::ListMeshReferences(grpc::CallbackServerContext* context,
                                                      const v1::ListMeshReferencesRequest* request,
                                                      v1::ListMeshReferencesResponse* response) {
  return list_mesh_references(engine_, *context, *request, response);
}

grpc::ServerWriteReactor<v1::GetParameterMeshResponse>* Service::GetParameterMesh(grpc::CallbackServerContext* context,
                                                                                  const v1::GetParameterMeshRequest* request) {
  return get_parameter_mesh(engine_, *context, *request);
}

grpc::ServerWriteReactor<v1::CreateSessionResponse>* Service::CreateSession(grpc::CallbackServerContext* context,
                                                                            const v1::CreateSessionRequest* request) {
  return create_session(engine_, *context, *request);
}

grpc::ServerUnaryReactor* Service::GetSession(grpc::CallbackServerContext* context, const v1::GetSessionRequest* request,
                                              v1::GetSessionResponse* response) {
  const std::string& id = request->session_id();
  if (engine_.sessions.must_load(id)) {
    return new UnaryJob(engine_, "GetSession", *context, [&]() -> absl::StatusOr<UnaryJob::Work> {
      return [this, id, response](const ExecutionContext& /*job*/) {
        const auto session = engine_.sessions.find(id);
        if (session.ok()) *response->mutable_session() = with_cached(to_proto(**session));
        return session.status();
      };
    });
  }
  return answer(engine_, "GetSession", context, [&] {
    const auto info = engine_.sessions.info(id);
    if (info.ok()) *response->mutable_session() = with_cached(to_proto(*info));
    return info.status();
  });
}

grpc::ServerUnaryReactor* Service::ListSessions(grpc::CallbackServerContext* context, const v1::ListSessionsRequest* request,
                                                v1::ListSessionsResponse* response) {
  return answer(engine_, "ListSessions", context, [&] {
    // A token is the last session_id of the page before.
    const std::string& token = request->page_token();
    if (!token.empty() && !is_id(token)) {
      return absl::InvalidArgumentError(absl::StrCat("page_token \"", printable(token), "\" is none that this server has given"));
    }
    const std::size_t size = request->page_size() == 0 ? kPageSize : std::min(request->page_size(), kMostOnPage);
    std::vector<SessionInfo> sessions = engine_.sessions.list(token, size + 1);
    if (sessions.size() > size) {
      sessions.pop_back();
      response->set_next_page_token(sessions.back().id);
    }
    for (const SessionInfo& info : sessions) *response->add_sessions() = with_cached(to_proto(info));
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* Service::UpdateSession(grpc::CallbackServerContext* context, const v1::UpdateSessionRequest* request,
                                                 v1::UpdateSessionResponse* response) {
  return new UnaryJob(engine_, "UpdateSession", *context, [&]() -> absl::StatusOr<UnaryJob::Work> {
    const auto pinned = request->has_pinned() ? std::optional(request->pinned()) : std::nullopt;
    const auto time_to_live = request->has_time_to_live() ? std::optional(request->time_to_live()) : std::nullopt;
    if (time_to_live && !(*time_to_live >= 0 && std::isfinite(*time_to_live))) {
      return absl::InvalidArgumentError(absl::StrCat("time_to_live is ", *time_to_live, "; it must be finite and not negative"));
    }
    return [this, id = request->session_id(), pinned, time_to_live, response](const ExecutionContext& /*job*/) {
      const auto info = engine_.sessions.update(id, pinned, time_to_live);
      if (info.ok()) *response->mutable_session() = with_cached(to_proto(*info));
      return info.status();
    };
  });
}

grpc::ServerUnaryReactor* Service::CloseSession(grpc::CallbackServerContext* context, const v1::CloseSessionRequest* request,
                                                v1::CloseSessionResponse* /*response*/) {
  return answer(engine_, "CloseSession", context, [&] { return engine_.close_session(request->session_id()); });
}

grpc::ServerWriteReactor<v1::MeasureResponse>* Service::Measure(grpc::CallbackServerContext* context,
                                                                const v1::MeasureRequest* request) {
  return measure(engine_, *context, *request);
}

grpc::ServerWriteReactor<v1::GetCurveResponse>* Service::GetCurve(grpc::CallbackServerContext* context,
                                                                  const v1::GetCurveRequest* request) {
  return get_curve(engine_, *context, *request);
}

grpc::ServerWriteReactor<v1::ResampleResponse>* Service::Resample(grpc::CallbackServerContext* context,
                                                                  const v1::ResampleRequest* request) {
  return resample(engine_, *context, *request);
}

grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* Service::StreamViews(
    grpc::CallbackServerContext* context) {
  return stream_views(engine_, *context);
}

}  // namespace curvecast::server
