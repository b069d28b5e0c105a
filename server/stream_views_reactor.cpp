// StreamViews: carries a ClientStream over gRPC.
#include <mutex>

#include "server/client_stream.h"
#include "server/grpc_status.h"
#include "server/reactors.h"
#include "server/request_log.h"

namespace curvecast::server {
namespace {

class StreamViewsReactor final : public grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>,
                                 public ClientStream::Transport {
 public:
  StreamViewsReactor(Engine& engine, const grpc::CallbackServerContext& context) : log_(*engine.log, "StreamViews", context) {
    auto stream = engine.make_stream(this);
    if (stream.ok()) {
      stream_ = *std::move(stream);
      read_next();
    } else {
      end(stream.status());
    }
  }

 private:
  void send(v1::StreamViewsResponse response) override {
    response_ = std::move(response);
    StartWrite(&response_);
  }

  void end(const absl::Status& status) override {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    log_.finish(to_grpc(status));
    Finish(to_grpc(status));
  }

  void OnReadDone(bool ok) override {
    if (!ok) return stream_->half_close();
    stream_->receive(request_);
    read_next();
  }
  void OnWriteDone(bool ok) override { stream_->sent(ok); }
  void OnCancel() override {
    if (stream_ != nullptr) stream_->stop(absl::CancelledError("the client has gone"));
  }
  void OnDone() override { delete this; }

  // No operation may start once Finish has been called.
  void read_next() {
    const std::lock_guard lock(mutex_);
    if (!ended_) StartRead(&request_);
  }

  RequestLog log_;
  std::shared_ptr<ClientStream> stream_;
  v1::StreamViewsRequest request_;
  v1::StreamViewsResponse response_;
  std::mutex mutex_;
  bool ended_ = false;
};

}  // namespace

grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* stream_views(Engine& engine,
                                                                                       grpc::CallbackServerContext& context) {
  return new StreamViewsReactor(engine, context);
}

}  // namespace curvecast::server
