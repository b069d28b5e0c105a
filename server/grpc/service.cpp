#include "server/grpc/service.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "server/base/grpc_status.h"
#include "server/base/log.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"
#include "server/engine/caller.h"
#include "server/engine/request_log.h"
#include "server/frame/render_picture.h"
#include "server/grpc/reactors.h"
#include "server/grpc/unary_job.h"
#include "server/session/cache_folder.h"
#include "server/session/import_mesh.h"

namespace curvecast::server {
namespace {

constexpr std::uint32_t kPageSize = 100, kMostOnPage = 1000;

/// A call that ends as it begins.
template <class Reactor>
class Refusal final : public Reactor {
 public:
  explicit Refusal(const grpc::Status& status) { this->Finish(status); }

 private:
  void OnDone() override { delete this; }
};

/// The reactor that `begin` makes for the caller; one that refuses the call, where nobody knows who that is.
template <class Begin>
std::invoke_result_t<Begin, const Caller&> check_caller(Engine& engine, const char* method, grpc::CallbackServerContext& context,
                                                        Begin&& begin) {
  const Peer peer = peer_of(engine, context);
  const absl::StatusOr<Caller> caller = identify(engine, peer);
  if (caller.ok()) {
    engine.connections->note_call(context.peer());
    return begin(*caller);
  }
  RequestLog(engine, method, context, {.address = peer.address}).finish(to_grpc(caller.status()));
  return new Refusal<std::remove_pointer_t<std::invoke_result_t<Begin, const Caller&>>>(to_grpc(caller.status()));
}

/// The page of a list that a request asks for. A token is the last id of the page before.
struct Page {
  std::string after;  // empty: from the first
  std::size_t size = 0;
};

/// InvalidArgument where the token is none.
template <class Request>
absl::StatusOr<Page> read_page(const Request& request) {
  const std::string& token = request.page_token();
  if (!token.empty() && !is_content_id(token)) {
    return absl::InvalidArgumentError(absl::StrCat("page_token \"", printable(token), "\" is none that this server has given"));
  }
  return Page{.after = token, .size = request.page_size() == 0 ? kPageSize : std::min(request.page_size(), kMostOnPage)};
}

/// As check_caller(), and answers on the spot: `work` is given the caller, and fills the response.
template <class Work>
grpc::ServerUnaryReactor* answer(Engine& engine, const char* method, grpc::CallbackServerContext& context, Work&& work) {
  return check_caller(engine, method, context, [&](const Caller& caller) -> grpc::ServerUnaryReactor* {
    RequestLog log(engine, method, context, caller);
    const grpc::Status status = to_grpc(status_from_exceptions([&] { return work(caller); }));
    log.finish(status);
    grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
    reactor->Finish(status);
    return reactor;
  });
}

/// As check_caller(), and a worker answers: see UnaryJob. `prepare` is given the caller.
template <class Prepare>
grpc::ServerUnaryReactor* answer_later(Engine& engine, const char* method, grpc::CallbackServerContext& context,
                                       const Prepare& prepare) {
  return check_caller(engine, method, context, [&](const Caller& caller) -> grpc::ServerUnaryReactor* {
    return new UnaryJob(engine, method, context, caller, [&] { return prepare(caller); });
  });
}

}  // namespace

v1::Session Service::with_cached(v1::Session session) const {
  session.set_cached(engine_.is_cached(session.session_id()));
  return session;
}

grpc::ServerReadReactor<v1::UploadMeshRequest>* Service::UploadMesh(grpc::CallbackServerContext* context,
                                                                    v1::UploadMeshResponse* response) {
  return check_caller(engine_, "UploadMesh", *context,
                      [&](const Caller& caller) { return upload_mesh(engine_, *context, caller, response); });
}

grpc::ServerUnaryReactor* Service::GetMesh(grpc::CallbackServerContext* context, const v1::GetMeshRequest* request,
                                           v1::GetMeshResponse* response) {
  return answer_later(engine_, "GetMesh", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
    return [this, response, id = request->mesh_id(), maker = caller.maker()](const ExecutionContext& job) {
      const auto mesh = engine_.meshes.find(id, maker.owner);
      if (!mesh.ok()) return mesh.status();
      // Who is told that it is here does not upload it.
      if (absl::Status opened = (*mesh)->open(job); !opened.ok()) return opened;
      if (engine_.knows_callers()) engine_.meshes.note_user((*mesh)->key, maker.caller);
      response->set_mesh_id((*mesh)->id);
      response->set_name((*mesh)->name);
      response->set_size((*mesh)->size());
      return absl::OkStatus();
    };
  });
}

grpc::ServerUnaryReactor* Service::ListMeshes(grpc::CallbackServerContext* context, const v1::ListMeshesRequest* request,
                                              v1::ListMeshesResponse* response) {
  return answer_later(engine_, "ListMeshes", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
    const absl::StatusOr<Page> page = read_page(*request);
    if (!page.ok()) return page.status();
    return [this, response, page = *page, maker = caller.maker()](const ExecutionContext& /*job*/) {
      std::vector<MeshStore::Listed> meshes = engine_.meshes.list(maker, !engine_.knows_callers(), page.after, page.size + 1);
      if (meshes.size() > page.size) {
        meshes.pop_back();
        response->set_next_page_token(meshes.back().id);
      }
      for (MeshStore::Listed& listed : meshes) {
        v1::StoredMesh& mesh = *response->add_meshes();
        mesh.set_mesh_id(std::move(listed.id));
        mesh.set_name(std::move(listed.name));
        mesh.set_size(listed.size);
      }
      return absl::OkStatus();
    };
  });
}

grpc::ServerUnaryReactor* Service::GetUpload(grpc::CallbackServerContext* context, const v1::GetUploadRequest* request,
                                             v1::GetUploadResponse* response) {
  return answer(engine_, "GetUpload", *context, [&](const Caller& caller) {
    response->set_received(engine_.meshes.received(request->mesh_id(), caller.maker()));
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* Service::ImportMesh(grpc::CallbackServerContext* context, const v1::ImportMeshRequest* request,
                                              v1::ImportMeshResponse* response) {
  return answer_later(engine_, "ImportMesh", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
    return [this, maker = caller.maker(), path = request->path(), response](const ExecutionContext& job) {
      const auto mesh = import_mesh(engine_.meshes, maker, engine_.mesh_folder, path, job);
      if (!mesh.ok()) return mesh.status();
      response->set_mesh_id((*mesh)->id);
      response->set_size((*mesh)->size());
      return absl::OkStatus();
    };
  });
}

grpc::ServerUnaryReactor* Service::InspectMesh(grpc::CallbackServerContext* context, const v1::InspectMeshRequest* request,
                                               v1::InspectMeshResponse* response) {
  return check_caller(engine_, "InspectMesh", *context,
                      [&](const Caller& caller) { return inspect_mesh(engine_, *context, caller, *request, response); });
}

grpc::ServerUnaryReactor* Service::ListMeshReferences(grpc::CallbackServerContext* context,
                                                      const v1::ListMeshReferencesRequest* request,
                                                      v1::ListMeshReferencesResponse* response) {
  return check_caller(engine_, "ListMeshReferences", *context,
                      [&](const Caller& caller) { return list_mesh_references(engine_, *context, caller, *request, response); });
}

grpc::ServerWriteReactor<v1::GetParameterMeshResponse>* Service::GetParameterMesh(grpc::CallbackServerContext* context,
                                                                                  const v1::GetParameterMeshRequest* request) {
  return check_caller(engine_, "GetParameterMesh", *context,
                      [&](const Caller& caller) { return get_parameter_mesh(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::CreateSessionResponse>* Service::CreateSession(grpc::CallbackServerContext* context,
                                                                            const v1::CreateSessionRequest* request) {
  return check_caller(engine_, "CreateSession", *context,
                      [&](const Caller& caller) { return create_session(engine_, *context, caller, *request); });
}

grpc::ServerUnaryReactor* Service::GetSession(grpc::CallbackServerContext* context, const v1::GetSessionRequest* request,
                                              v1::GetSessionResponse* response) {
  const std::string& id = request->session_id();
  if (engine_.sessions.must_load(id)) {
    return answer_later(engine_, "GetSession", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
      return [this, id, who = caller.owner, response](const ExecutionContext& /*job*/) {
        const auto session = engine_.sessions.find(id, who);
        if (session.ok()) *response->mutable_session() = with_cached(to_proto(**session));
        return session.status();
      };
    });
  }
  return answer(engine_, "GetSession", *context, [&](const Caller& caller) {
    const auto info = engine_.sessions.info(id, caller.owner);
    if (info.ok()) *response->mutable_session() = with_cached(to_proto(*info));
    return info.status();
  });
}

grpc::ServerUnaryReactor* Service::ListSessions(grpc::CallbackServerContext* context, const v1::ListSessionsRequest* request,
                                                v1::ListSessionsResponse* response) {
  return answer(engine_, "ListSessions", *context, [&](const Caller& caller) {
    const absl::StatusOr<Page> page = read_page(*request);
    if (!page.ok()) return page.status();
    std::vector<SessionInfo> sessions = engine_.sessions.list(page->after, page->size + 1, caller.owner);
    if (sessions.size() > page->size) {
      sessions.pop_back();
      response->set_next_page_token(sessions.back().id);
    }
    for (const SessionInfo& info : sessions) *response->add_sessions() = with_cached(to_proto(info));
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* Service::UpdateSession(grpc::CallbackServerContext* context, const v1::UpdateSessionRequest* request,
                                                 v1::UpdateSessionResponse* response) {
  return answer_later(engine_, "UpdateSession", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
    const auto pinned = request->has_pinned() ? std::optional(request->pinned()) : std::nullopt;
    const auto time_to_live = request->has_time_to_live() ? std::optional(request->time_to_live()) : std::nullopt;
    if (time_to_live && !(*time_to_live >= 0 && std::isfinite(*time_to_live))) {
      return absl::InvalidArgumentError(absl::StrCat("time_to_live is ", *time_to_live, "; it must be finite and not negative"));
    }
    return
        [this, id = request->session_id(), pinned, time_to_live, who = caller.owner, response](const ExecutionContext& /*job*/) {
          const auto info = engine_.sessions.update(id, pinned, time_to_live, who);
          if (info.ok()) *response->mutable_session() = with_cached(to_proto(*info));
          return info.status();
        };
  });
}

grpc::ServerUnaryReactor* Service::CloseSession(grpc::CallbackServerContext* context, const v1::CloseSessionRequest* request,
                                                v1::CloseSessionResponse* /*response*/) {
  return answer_later(engine_, "CloseSession", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
    return [this, id = request->session_id(), who = caller.owner](const ExecutionContext& /*job*/) {
      return engine_.close_session(id, who);
    };
  });
}

grpc::ServerUnaryReactor* Service::Render(grpc::CallbackServerContext* context, const v1::RenderRequest* request,
                                          v1::RenderResponse* response) {
  return answer_later(engine_, "Render", *context, [&](const Caller& caller) -> absl::StatusOr<UnaryJob::Work> {
    return [this, request, who = caller.owner, response](const ExecutionContext& job) {
      const auto session = engine_.sessions.find(request->session_id(), who);
      if (!session.ok()) return session.status();
      auto picture = render_picture(**session, *request, engine_.view_cache, job);
      if (absl::Status checked = engine_.sessions.check(**session); !checked.ok()) return checked;
      if (!picture.ok()) return picture.status();
      *response = *std::move(picture);
      return absl::OkStatus();
    };
  });
}

grpc::ServerWriteReactor<v1::ScatterResponse>* Service::Scatter(grpc::CallbackServerContext* context,
                                                                const v1::ScatterRequest* request) {
  return check_caller(engine_, "Scatter", *context,
                      [&](const Caller& caller) { return scatter(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::MeasureResponse>* Service::Measure(grpc::CallbackServerContext* context,
                                                                const v1::MeasureRequest* request) {
  return check_caller(engine_, "Measure", *context,
                      [&](const Caller& caller) { return measure(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::RemeshResponse>* Service::Remesh(grpc::CallbackServerContext* context,
                                                              const v1::RemeshRequest* request) {
  return check_caller(engine_, "Remesh", *context,
                      [&](const Caller& caller) { return remesh(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::GetSurfaceResponse>* Service::GetSurface(grpc::CallbackServerContext* context,
                                                                      const v1::GetSurfaceRequest* request) {
  return check_caller(engine_, "GetSurface", *context,
                      [&](const Caller& caller) { return get_surface(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::GetCurveResponse>* Service::GetCurve(grpc::CallbackServerContext* context,
                                                                  const v1::GetCurveRequest* request) {
  return check_caller(engine_, "GetCurve", *context,
                      [&](const Caller& caller) { return get_curve(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::ResampleResponse>* Service::Resample(grpc::CallbackServerContext* context,
                                                                  const v1::ResampleRequest* request) {
  return check_caller(engine_, "Resample", *context,
                      [&](const Caller& caller) { return resample(engine_, *context, caller, *request); });
}

grpc::ServerWriteReactor<v1::FindNeighboursResponse>* Service::FindNeighbours(grpc::CallbackServerContext* context,
                                                                              const v1::FindNeighboursRequest* request) {
  return check_caller(engine_, "FindNeighbours", *context,
                      [&](const Caller& caller) { return find_neighbours(engine_, *context, caller, *request); });
}

grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* Service::StreamViews(
    grpc::CallbackServerContext* context) {
  return check_caller(engine_, "StreamViews", *context,
                      [&](const Caller& caller) { return stream_views(engine_, *context, caller); });
}

}  // namespace curvecast::server
