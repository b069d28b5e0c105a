#include "server/service.h"

#include "server/convert.h"
#include "server/grpc_status.h"
#include "server/guarded.h"
#include "server/reactors.h"
#include "server/request_log.h"
#include "server/unary_job.h"

namespace curvecast::server {
namespace {

// Answers on the spot.
template <class Answer>
grpc::ServerUnaryReactor* answer(Engine& engine, const char* method, grpc::CallbackServerContext* context, Answer&& work) {
  RequestLog log(engine, method, *context);
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

grpc::ServerUnaryReactor* Service::ListSessions(grpc::CallbackServerContext* context, const v1::ListSessionsRequest* /*request*/,
                                                v1::ListSessionsResponse* response) {
  return answer(engine_, "ListSessions", context, [&] {
    for (const SessionInfo& info : engine_.sessions.list()) *response->add_sessions() = with_cached(to_proto(info));
    return absl::OkStatus();
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
