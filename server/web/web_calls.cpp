#include "server/web/web_calls.h"

#include <absl/strings/str_cat.h>
#include <grpcpp/channel.h>
#include <spdlog/logger.h>

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/base/mutex.h"
#include "curvecast/v1/curvecast.pb.h"
#include "curvecast/v1/web_socket.pb.h"
#include "server/base/grpc_status.h"
#include "server/base/log.h"
#include "server/base/protocol.h"
#include "server/web/web_call.h"

namespace curvecast::server {
namespace {

/// Those that have not ended, by number. Thread-safe, because calls end on threads of their own.
class OpenCalls {
 public:
  void add(std::uint32_t number, std::shared_ptr<WebCall> call) {
    const MutexLock lock(mutex_);
    if (const auto at = calls_.find(number); at != calls_.end()) at->second = std::move(call);  // else it has ended already
  }
  void reserve(std::uint32_t number) {
    const MutexLock lock(mutex_);
    calls_[number];
  }
  void remove(std::uint32_t number) {
    const MutexLock lock(mutex_);
    calls_.erase(number);
  }
  std::shared_ptr<WebCall> find(std::uint32_t number) const {
    const MutexLock lock(mutex_);
    const auto at = calls_.find(number);
    return at == calls_.end() ? nullptr : at->second;
  }
  std::size_t size() const {
    const MutexLock lock(mutex_);
    return calls_.size();
  }
  std::map<std::uint32_t, std::shared_ptr<WebCall>> take_all() {
    const MutexLock lock(mutex_);
    return std::exchange(calls_, {});
  }

 private:
  mutable Mutex mutex_;
  std::map<std::uint32_t, std::shared_ptr<WebCall>> calls_ ABSL_GUARDED_BY(mutex_);
};

/// Of a caller who is not known, or not any more.
void close(WebSocket& socket, const absl::Status& why) { socket.close(WebSocketClose::kRefused, std::string(why.message())); }

class WebCalls final : public WebConversation {
 public:
  WebCalls(Engine& engine, std::shared_ptr<grpc::Channel> channel, std::shared_ptr<WebSocket> socket, WebVisitor visitor)
      : engine_(engine),
        channel_(std::move(channel)),
        socket_(std::move(socket)),
        visitor_(std::move(visitor)),
        watched_(engine.callers, *visitor_.caller, [weak = std::weak_ptr(socket_)](const absl::Status& why) {
          if (const auto open = weak.lock()) close(*open, why);
        }) {}

  ~WebCalls() override {
    for (const auto& [number, call] : open_->take_all()) {
      if (call != nullptr) call->cancel();
    }
  }

  void receive(std::string_view message) override {
    v1::CallRequest request;
    if (!request.ParseFromArray(message.data(), static_cast<int>(message.size())) || request.call() == 0) {
      return socket_->close(WebSocketClose::kBadMessage, "a message is no CallRequest");
    }
    if (!request.method().empty()) {
      if (const absl::Status allowed = check(request); !allowed.ok()) return refuse(request.call(), allowed);
    }
    const std::shared_ptr<WebCall> call = request.method().empty() ? open_->find(request.call()) : begin(request);
    if (call == nullptr) return socket_->read_on();  // it has ended: its client is being told
    if (request.cancel()) call->cancel();
    const auto resume = [socket = socket_, call, ends = request.half_close()] {
      if (ends) call->half_close();
      socket->read_on();
    };
    if (!request.has_message()) return resume();
    call->receive(std::move(*request.mutable_message()), resume);
  }

 private:
  std::shared_ptr<WebCall> begin(const v1::CallRequest& request) {
    const std::uint32_t number = request.call();
    last_ = number;
    open_->reserve(number);
    WebCallContext context{socket_, number, visitor_, [open = open_, number] { open->remove(number); }};
    const std::string path = absl::StrCat("/", service().full_name(), "/", request.method());
    auto call = request.method() == "StreamViews" ? begin_views_call(engine_, std::move(context))
                                                  : begin_grpc_call(channel_, path, std::move(context));
    open_->add(number, call);
    return call;
  }

  /// Nothing is read until the client has taken the answer: otherwise they could pile up.
  void refuse(std::uint32_t number, const absl::Status& why) {
    socket_->send(status_response(number, to_grpc(why)), [socket = socket_](bool /*ok*/) { socket->read_on(); });
  }

  absl::Status check(const v1::CallRequest& request) const {
    if (service().FindMethodByName(request.method()) == nullptr) {
      return absl::UnimplementedError(absl::StrCat("there is no method \"", printable(request.method()), "\""));
    }
    if (request.call() <= last_) return absl::InvalidArgumentError("the numbers of calls must grow");
    if (open_->size() >= kMaxSocketCalls) {
      return absl::ResourceExhaustedError(absl::StrCat("this socket has ", kMaxSocketCalls, " calls; wait for one to end"));
    }
    return absl::OkStatus();
  }

  static const google::protobuf::ServiceDescriptor& service() { return *v1::UploadMeshRequest::descriptor()->file()->service(0); }

  Engine& engine_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::shared_ptr<WebSocket> socket_;
  const WebVisitor visitor_;
  const CallerWatch::Ticket watched_;
  const std::shared_ptr<OpenCalls> open_ = std::make_shared<OpenCalls>();
  std::uint32_t last_ = 0;  // number of the newest call
};

}  // namespace

WebConversationMaker web_calls(Engine& engine, std::shared_ptr<grpc::Channel> channel) {
  return [&engine, channel = std::move(channel)](const std::shared_ptr<WebSocket>& socket,
                                                 const WebVisitor& visitor) -> std::unique_ptr<WebConversation> {
    const absl::Status& known = visitor.caller.status();
    if (known.ok()) return std::make_unique<WebCalls>(engine, channel, socket, visitor);
    engine.metrics.unauthenticated();
    engine.log->info("http: refused {}: {}", visitor.peer.address, std::string(known.message()));
    close(*socket, known);
    return nullptr;
  };
}

}  // namespace curvecast::server
