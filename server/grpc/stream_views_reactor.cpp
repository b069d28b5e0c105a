// StreamViews: carries a ClientStream over gRPC.
#include <memory>
#include <optional>
#include <utility>

#include "core/base/mutex.h"
#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/engine/request_log.h"
#include "server/engine/view_conversation.h"
#include "server/frame/client_stream.h"
#include "server/grpc/reactors.h"
#include "server/grpc/watched_messages.h"

namespace curvecast::server {
namespace {

class StreamViewsReactor final : public grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>,
                                 public ClientStream::Transport {
 public:
  StreamViewsReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller)
      : log_(engine, "StreamViews", context, caller), sends_(engine.sends, context) {
    auto conversation = ViewConversation::begin(engine, this, caller);
    if (conversation.ok()) {
      conversation_ = *std::move(conversation);
      StartRead(&request_);
    } else {
      finish(conversation.status());
    }
  }

 private:
  void send(v1::StreamViewsResponse response) override {
    response_ = std::move(response);
    conversation_->count_sent(response_);
    sends_.begin();
    StartWrite(&response_);
  }

  void end(const absl::Status& status) override {
    {
      const MutexLock lock(mutex_);
      ended_ = status;
      if (taking_) return conversation_->end_pause();  // resume() finishes: until then, the reactor stays
    }
    finish(status);
  }

  void finish(const absl::Status& status) {
    if (conversation_ != nullptr) conversation_->release_admission();
    const grpc::Status ended = sends_.end_of(to_grpc(status));
    log_.finish(ended);
    Finish(ended);
  }

  void OnReadDone(bool ok) override {
    if (!ok) return conversation_->stream().half_close();
    {
      const MutexLock lock(mutex_);
      if (ended_) return;
      taking_ = true;
    }
    go_on([this] { conversation_->receive(request_, [this] { resume(); }); }, true);
  }

  /// Does a step of the conversation, and ends the call where it throws: gRPC would leave it open for ever. `takes`: the step was
  /// to take a message.
  template <typename Step>
  void go_on(const Step& step, bool takes = false) {
    const absl::Status status = status_from_exceptions([&] {
      step();
      return absl::OkStatus();
    });
    if (status.ok()) return;
    if (takes) {
      const MutexLock lock(mutex_);
      taking_ = false;
    }
    conversation_->stream().stop(status);
  }

  /// Reads the next message, or finishes what has ended meanwhile.
  void resume() {
    std::optional<absl::Status> ended;
    {
      const MutexLock lock(mutex_);
      taking_ = false;
      ended = ended_;
      if (!ended) StartRead(&request_);  // no operation may start once Finish has been called
    }
    if (ended) finish(*ended);
  }

  void OnWriteDone(bool ok) override {
    sends_.done();
    go_on([&] { conversation_->stream().sent(ok); });
  }
  void OnCancel() override {
    if (conversation_ != nullptr) conversation_->stream().stop(absl::CancelledError("the client has gone"));
  }
  void OnDone() override { delete this; }

  RequestLog log_;
  WatchedMessages sends_;
  std::unique_ptr<ViewConversation> conversation_;  // null: refused
  v1::StreamViewsRequest request_;
  v1::StreamViewsResponse response_;
  Mutex mutex_;
  std::optional<absl::Status> ended_ ABSL_GUARDED_BY(mutex_);  // no operation may start any more
  bool taking_ ABSL_GUARDED_BY(mutex_) = false;                // a message; none is read meanwhile
};

}  // namespace

grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* stream_views(Engine& engine,
                                                                                       grpc::CallbackServerContext& context,
                                                                                       const Caller& caller) {
  return new StreamViewsReactor(engine, context, caller);
}

}  // namespace curvecast::server
