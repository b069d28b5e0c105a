// StreamViews over a WebSocket.
#include <optional>
#include <utility>

#include "core/base/mutex.h"
#include "server/base/grpc_status.h"
#include "server/engine/request_log.h"
#include "server/engine/view_conversation.h"
#include "server/web/web_call.h"

namespace curvecast::server {
namespace {

class WebViewsCall final : public WebCall, public ClientStream::Transport, public std::enable_shared_from_this<WebViewsCall> {
 public:
  WebViewsCall(Engine& engine, WebCallContext context)
      : context_(std::move(context)), log_(engine, "StreamViews", *context_.visitor.caller), sends_(engine.sends) {}

  void begin(Engine& engine) {
    self_ = shared_from_this();
    const Caller& caller = *context_.visitor.caller;
    if (const absl::Status refused = check(engine, caller); !refused.ok()) return finish(refused);  // by now
    auto conversation = ViewConversation::begin(engine, this, caller);
    if (!conversation.ok()) return finish(conversation.status());
    conversation_ = *std::move(conversation);
  }

  void receive(std::string message, std::function<void()> on_taken) override {
    bool takes = false;
    {
      const MutexLock lock(mutex_);
      takes = taking_ = !ended_ && conversation_ != nullptr;
    }
    if (!takes) return on_taken();
    if (!request_.ParseFromString(message)) {
      conversation_->stream().stop(absl::InvalidArgumentError("a message is no StreamViewsRequest"));
      return resume(on_taken);
    }
    conversation_->receive(request_, [self = self_, on_taken = std::move(on_taken)] { self->resume(on_taken); });
  }

  void half_close() override {
    if (conversation_ != nullptr) conversation_->stream().half_close();
  }

  void cancel() override {
    if (conversation_ != nullptr) conversation_->stream().stop(absl::CancelledError("the client has gone"));
  }

 private:
  void send(v1::StreamViewsResponse response) override {
    conversation_->count_sent(response);
    sends_.begin(this, [this](const absl::Status&) { context_.socket->drop(); });
    context_.socket->send(message_response(context_.number, response), [self = self_](bool ok) {
      self->sends_.done(self.get());
      self->conversation_->stream().sent(ok);
    });
  }

  void end(const absl::Status& status) override {
    {
      const MutexLock lock(mutex_);
      ended_ = status;
      if (taking_) return conversation_->end_pause();  // resume() finishes
    }
    finish(status);
  }

  void resume(const std::function<void()>& on_taken) {
    std::optional<absl::Status> ended;
    {
      const MutexLock lock(mutex_);
      taking_ = false;
      ended = ended_;
    }
    if (ended) finish(*ended);
    on_taken();
  }

  void finish(const absl::Status& status) {
    if (conversation_ != nullptr) conversation_->release_admission();
    log_.finish(to_grpc(status));
    const std::shared_ptr<WebSocket> socket = context_.socket;  // this may go at once
    socket->send(status_response(context_.number, to_grpc(status)),
                 [self = std::move(self_)](bool /*ok*/) { self->context_.on_ended(); });
  }

  const WebCallContext context_;
  RequestLog log_;
  StallWatch& sends_;
  std::unique_ptr<ViewConversation> conversation_;  // null: refused
  v1::StreamViewsRequest request_;
  Mutex mutex_;
  std::optional<absl::Status> ended_ ABSL_GUARDED_BY(mutex_);
  bool taking_ ABSL_GUARDED_BY(mutex_) = false;  // a message
  std::shared_ptr<WebViewsCall> self_;           // until it ends
};

}  // namespace

std::shared_ptr<WebCall> begin_views_call(Engine& engine, WebCallContext context) {
  auto call = std::make_shared<WebViewsCall>(engine, std::move(context));
  call->begin(engine);
  return call;
}

}  // namespace curvecast::server
