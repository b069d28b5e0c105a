// Any call of the API over a WebSocket, passed on to gRPC within this process, message by message.
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/generic/generic_stub.h>

#include <utility>

#include "core/base/mutex.h"
#include "server/engine/caller.h"
#include "server/web/web_call.h"

namespace curvecast::server {
namespace {

/// Keeps itself from start() to OnDone(). Holds keep gRPC from ending the call while either side may still start an operation.
class WebGrpcCall final : public WebCall,
                          public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                          public std::enable_shared_from_this<WebGrpcCall> {
 public:
  WebGrpcCall(const std::shared_ptr<grpc::Channel>& channel, WebCallContext context)
      : context_(std::move(context)), stub_(channel) {
    introduce(context_.visitor.peer, client_);
  }

  void start(const std::string& path) {
    self_ = shared_from_this();
    stub_.PrepareBidiStreamingCall(&client_, path, {}, this);
    AddMultipleHolds(2);  // of those who write and those who read
    StartRead(&response_);
    StartCall();
  }

  void receive(std::string message, std::function<void()> on_taken) override {
    {
      const MutexLock lock(mutex_);
      if (!done_writing_) {
        const grpc::Slice slice(message);
        request_ = grpc::ByteBuffer(&slice, 1);
        on_taken_ = std::move(on_taken);
        StartWrite(&request_);
        return;
      }
    }
    on_taken();
  }

  void half_close() override {
    const MutexLock lock(mutex_);
    if (done_writing_) return;
    StartWritesDone();
    end_writing();
  }

  void cancel() override {
    client_.TryCancel();
    const MutexLock lock(mutex_);
    if (on_taken_ == nullptr) end_writing();  // else once that write has failed
  }

 private:
  void OnWriteDone(bool ok) override {
    std::function<void()> on_taken;
    {
      const MutexLock lock(mutex_);
      on_taken.swap(on_taken_);
      if (!ok || done_reading_) end_writing();  // the call is over: whatever comes is for nobody
    }
    on_taken();
  }

  void OnReadDone(bool ok) override {
    if (!ok) {
      // The server reads no more, so that nothing holds what is to be written.
      const MutexLock lock(mutex_);
      done_reading_ = true;
      if (on_taken_ == nullptr) end_writing();
      return RemoveHold();
    }
    context_.socket->send(message_response(context_.number, response_), [self = self_](bool sent) {
      if (!sent) self->client_.TryCancel();
      self->response_.Clear();
      self->StartRead(&self->response_);
    });
  }

  void OnDone(const grpc::Status& status) override {
    const std::shared_ptr<WebSocket> socket = context_.socket;  // this may go at once
    socket->send(status_response(context_.number, status), [self = std::move(self_)](bool /*ok*/) { self->context_.on_ended(); });
  }

  void end_writing() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (!std::exchange(done_writing_, true)) RemoveHold();
  }

  const WebCallContext context_;
  grpc::GenericStub stub_;
  grpc::ClientContext client_;
  grpc::ByteBuffer response_;
  Mutex mutex_;
  grpc::ByteBuffer request_ ABSL_GUARDED_BY(mutex_);
  std::function<void()> on_taken_ ABSL_GUARDED_BY(mutex_);  // of the message being written; null: none is
  bool done_writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool done_reading_ ABSL_GUARDED_BY(mutex_) = false;
  std::shared_ptr<WebGrpcCall> self_;
};

}  // namespace

std::shared_ptr<WebCall> begin_grpc_call(const std::shared_ptr<grpc::Channel>& channel, const std::string& path,
                                         WebCallContext context) {
  auto call = std::make_shared<WebGrpcCall>(channel, std::move(context));
  call->start(path);
  return call;
}

}  // namespace curvecast::server
