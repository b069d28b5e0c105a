#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>
#include <spdlog/logger.h>

#include <chrono>

namespace curvecast::server {

/// The line of one request in the log, written when it is over.
class RequestLog {
 public:
  /// `method` is a literal.
  RequestLog(spdlog::logger& log, const char* method, const grpc::CallbackServerContext& context) : log_(log), method_(method) {
    if (log_.should_log(spdlog::level::debug)) peer_ = context.peer();
  }

  void finish(const grpc::Status& status) {
    if (!log_.should_log(spdlog::level::debug)) return;
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start_;
    log_.debug("{} from {}: code {} after {:.2f} ms {}", method_, peer_, static_cast<int>(status.error_code()), elapsed.count(),
               status.error_message());
  }

 private:
  spdlog::logger& log_;
  const char* method_;
  std::string peer_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace curvecast::server
