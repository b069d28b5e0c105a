// The server's HTTP port, for those who watch over it.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace spdlog {
class logger;
}

namespace curvecast::server {

struct WebAnswer {
  int status = 200;
  std::string body = {};
  std::string type = "text/plain; charset=utf-8";
};

/// What answers GET and HEAD of a path, by path. Called on the gateway's thread, one at a time: whatever takes long there delays
/// all others.
using WebRoutes = std::map<std::string, std::function<WebAnswer()>, std::less<>>;

struct WebGatewayOptions {
  std::string listen;                 // "host:port"; port 0 = any free one
  std::size_t max_connections = 128;  // further ones wait until one of them has gone
  std::chrono::milliseconds time_out{
      10'000};  // for a request to arrive whole, an answer to be taken, and the next request to come
};

/// HTTP/1.1 with keep-alive, on one thread. Requests have at most 8 KiB of header and no body. Thread-safe.
class WebGateway {
 public:
  /// Unavailable (address in use, or not one of this machine's) or InvalidArgument (malformed address).
  static absl::StatusOr<std::unique_ptr<WebGateway>> start(const WebGatewayOptions& options, WebRoutes routes,
                                                           std::shared_ptr<spdlog::logger> log);
  virtual ~WebGateway() = default;  // closes all connections at once

  virtual int port() const = 0;
};

}  // namespace curvecast::server
