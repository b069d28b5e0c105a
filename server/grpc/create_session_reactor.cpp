// CreateSession: waits for a session and tells how far it is.
#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"
#include "server/grpc/reactors.h"
#include "server/grpc/write_queue.h"
#include "server/session/mesh_files.h"
#include "server/session/overall_progress.h"

namespace curvecast::server {
namespace {

// Either the store's on_done or a successful leave() finishes, never both.
class CreateSessionReactor final : public WriteQueue<v1::CreateSessionResponse>, public SessionWaiter {
 public:
  CreateSessionReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                       const v1::CreateSessionRequest& request)
      : WriteQueue("CreateSession", engine, context, caller), engine_(engine), wants_preview_(!request.without_preview()) {
    // Whatever join() sets off, gRPC holds back until the reactor is bound, which is after this constructor; the queue, until
    // another thread has begun.
    begin_with_meshes(engine, [this, &request] { return begin(request); });
  }

 private:
  absl::Status begin(const v1::CreateSessionRequest& request) {
    auto files = find_files(engine_.meshes, request.mesh_id(), request.companions(), caller().owner);
    if (!files.ok()) return files.status();
    const auto options = to_preprocess_options(request.options());
    if (!options.ok()) return options.status();
    auto id = engine_.sessions.join(*std::move(files), *options, this, caller().maker());
    if (!id.ok()) return id.status();
    {
      const MutexLock lock(id_mutex_);
      id_ = *std::move(id);
    }
    if (cancelled()) leave();  // before it was known what to leave
    return absl::OkStatus();
  }

  void on_progress(std::string_view stage, double fraction) override {
    v1::CreateSessionResponse response;
    response.mutable_progress()->set_stage(std::string(stage));
    response.mutable_progress()->set_fraction(fraction);
    response.mutable_progress()->set_overall(overall_progress(stage, fraction));
    push(std::move(response));
  }

  bool wants_preview() const override { return wants_preview_; }

  void on_preview(const std::shared_ptr<const Session>& preview) override {
    if (!wants_preview_) return;
    v1::CreateSessionResponse response;
    *response.mutable_preview() = to_proto(*preview);
    push(std::move(response));
  }

  void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) override {
    if (session.ok()) {
      v1::CreateSessionResponse response;
      *response.mutable_session() = to_proto(**session);
      response.mutable_session()->set_cached(engine_.is_cached((*session)->id));
      push(std::move(response));
    }
    const grpc::Status status = to_grpc(session.status());
    session = absl::CancelledError();  // a session that somebody refers to is not idle, and the client may count on that
    finish(status);
  }

  // A client that reads slowly gets the start and the newest state of every stage.
  bool replaces(const v1::CreateSessionResponse& newer, const v1::CreateSessionResponse& older) const override {
    return newer.has_progress() && older.has_progress() && newer.progress().stage() == older.progress().stage() &&
           older.progress().fraction() > 0;
  }

  void OnCancel() override {
    WriteQueue::OnCancel();
    leave();
  }

  void leave() ABSL_LOCKS_EXCLUDED(id_mutex_) {
    std::string id;
    {
      const MutexLock lock(id_mutex_);
      id = id_;
    }
    if (engine_.sessions.leave(id, this)) finish(grpc::Status::CANCELLED);
  }

  Engine& engine_;
  const bool wants_preview_;
  Mutex id_mutex_;
  std::string id_ ABSL_GUARDED_BY(id_mutex_);  // empty: it has not joined
};

}  // namespace

grpc::ServerWriteReactor<v1::CreateSessionResponse>* create_session(Engine& engine, grpc::CallbackServerContext& context,
                                                                    const Caller& caller,
                                                                    const v1::CreateSessionRequest& request) {
  return new CreateSessionReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
