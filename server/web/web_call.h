// One call of the API over a WebSocket: what CallRequest and CallResponse of web_socket.proto wrap.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "curvecast/v1/curvecast.pb.h"
#include "server/engine/engine.h"
#include "server/web/web_socket.h"

namespace grpc {
class Channel;
}

namespace curvecast::server {

/// Held by shared_ptr, and holds itself until it has ended. Called by one thread at a time, but for its own callbacks.
class WebCall {
 public:
  virtual ~WebCall() = default;
  /// Takes the next request message. Calls `on_taken` once the next one may come, on any thread, also within this call.
  virtual void receive(std::string message, std::function<void()> on_taken) = 0;
  /// No request message follows.
  virtual void half_close() = 0;
  /// Ends the call: its client does not wait for it any more.
  virtual void cancel() = 0;
};

/// The socket that a call is on, its number there, and its client.
struct WebCallContext {
  std::shared_ptr<WebSocket> socket;
  std::uint32_t number = 0;
  WebVisitor visitor;              // who is known
  std::function<void()> on_ended;  // called on any thread, last of all
};

/// Begins a StreamViews: a ClientStream, without gRPC in between.
std::shared_ptr<WebCall> begin_views_call(Engine& engine, WebCallContext context);

/// Begins a call of any other method, through a channel to this process. `path`: as in
/// "/curvecast.v1.CurvecastService/ListSessions".
std::shared_ptr<WebCall> begin_grpc_call(const std::shared_ptr<grpc::Channel>& channel, const std::string& path,
                                         WebCallContext context);

/// The bytes of a CallResponse with a message, which is copied once.
std::string message_response(std::uint32_t call, const v1::StreamViewsResponse& message);
std::string message_response(std::uint32_t call, const grpc::ByteBuffer& message);
/// The bytes of the last CallResponse of a call.
std::string status_response(std::uint32_t call, const grpc::Status& status);

}  // namespace curvecast::server
