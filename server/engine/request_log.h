#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <string>
#include <string_view>

#include "server/engine/engine.h"

namespace curvecast::server {

/// What a client may call its request: 1 to 64 printable characters.
bool is_request_id(std::string_view id);

/// The trace of one request: its id, which the client gets as initial metadata, and when it is over a line in the log and its
/// count.
class RequestLog {
 public:
  /// `method` is a literal. The id is the client's x-request-id where that is one, else a random one. Nothing may have been
  /// sent yet.
  RequestLog(Engine& engine, const char* method, grpc::CallbackServerContext& context);

  /// The same of a call that does not come through gRPC; its id is known to nobody but the log.
  RequestLog(Engine& engine, const char* method, std::string peer);

  void finish(const grpc::Status& status);

 private:
  Engine& engine_;
  const char* method_;
  std::string id_;
  std::string peer_;  // only where it is logged
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace curvecast::server
