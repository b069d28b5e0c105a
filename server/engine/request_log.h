// What is logged and counted of each request.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <string>
#include <string_view>

#include "server/engine/caller.h"
#include "server/engine/engine.h"

namespace curvecast::server {

/// Whether a client may call its request so: 1 to 64 visible characters, none of them a blank, after which a line of the log
/// could seem to have further fields.
bool is_request_id(std::string_view id);

/// Follows one request: gives it an id, which the client gets as initial metadata, and writes a line and counts the request when
/// it is over.
class RequestLog {
 public:
  /// `method` is a literal; of a caller who was refused only the address is known. The id is the client's x-request-id where that
  /// is one, else a random one. Nothing may have been sent yet.
  RequestLog(Engine& engine, const char* method, grpc::CallbackServerContext& context, const Caller& caller);

  /// Follows a call that does not come through gRPC. Only the log has its id.
  RequestLog(Engine& engine, const char* method, const Caller& caller);

  /// Logs and counts the request. To be called once, when it is over.
  void finish(const grpc::Status& status);

 private:
  RequestLog(Engine& engine, const char* method, std::string id, const Caller& caller);

  Engine& engine_;
  const char* method_;
  std::string id_;
  std::string caller_, peer_;  // only where they are logged
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace curvecast::server
