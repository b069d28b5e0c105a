// GetCurve: sends a session's curve chunk by chunk.
#include <memory>
#include <string>

#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/curve_chunks.h"
#include "server/engine/request_log.h"
#include "server/grpc/reactors.h"

namespace curvecast::server {
namespace {

// Packs a chunk when the one before has gone, which takes about a millisecond: a client that reads slowly, or not at all, never
// makes the server hold more than one. The curve is that of the beginning, whatever becomes of its session, of which this is a
// copy: who reads slowly does not keep it from being evicted.
class CurveReactor final : public grpc::ServerWriteReactor<v1::GetCurveResponse> {
 public:
  CurveReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, const v1::GetCurveRequest& request)
      : sessions_(engine.sessions), who_(caller.owner), log_(engine, "GetCurve", context, caller) {
    const std::string& id = request.session_id();
    if (engine.sessions.must_load(id)) {
      // A thread that may wait for the disk, or the store, loads it.
      const auto submitted = engine.cache->loading(id).submit([this, id] { begin(id); });
      if (!submitted.ok()) end(submitted.status());
    } else {
      begin(id);
    }
  }

 private:
  void begin(const std::string& id) {
    const absl::Status begun = status_from_exceptions([&] {
      const auto session = sessions_.find(id, who_);
      if (!session.ok()) return session.status();
      session_ = **session;
      curve_ = session_.curve();
      *message_.mutable_info() = to_curve_info(*curve_);
      return sessions_.check(session_);
    });
    begun.ok() ? StartWrite(&message_) : end(begun);
  }

  void OnWriteDone(bool ok) override {
    if (!ok) return end(absl::CancelledError("the client has gone"));
    if (next_ == curve_->size()) return end(absl::OkStatus());
    const absl::Status packed = status_from_exceptions([&] {
      message_.Clear();
      *message_.mutable_chunk() = to_curve_chunk(*curve_, next_);
      next_ += message_.chunk().count();
      return sessions_.check(session_);
    });
    packed.ok() ? StartWrite(&message_) : end(packed);
  }

  void OnDone() override { delete this; }

  void end(const absl::Status& status) {
    const grpc::Status sent = to_grpc(status);
    log_.finish(sent);
    Finish(sent);
  }

  SessionStore& sessions_;
  const std::string who_;
  RequestLog log_;
  Session session_;
  std::shared_ptr<const SurfaceCurve> curve_;
  v1::GetCurveResponse message_;  // being written
  std::size_t next_ = 0;          // vertex
};

}  // namespace

grpc::ServerWriteReactor<v1::GetCurveResponse>* get_curve(Engine& engine, grpc::CallbackServerContext& context,
                                                          const Caller& caller, const v1::GetCurveRequest& request) {
  return new CurveReactor(engine, context, caller, request);
}

}  // namespace curvecast::server
