// The server's HTTP port: pages, health and metrics, and WebSockets.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "server/net/trusted_proxies.h"
#include "server/web/credentials.h"
#include "server/web/web_exchange.h"
#include "server/web/web_origin.h"
#include "server/web/web_socket.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// The functions that answer GET and HEAD, by path. Called on the gateway's thread, one at a time: one that takes long delays all
/// others.
using WebRoutes = std::map<std::string, std::function<WebAnswer()>, std::less<>>;

/// A request that is answered later.
struct WebQuestion {
  Peer peer;               // who asks, unchecked
  std::string query = {};  // what follows the path's "?", as it came
};
/// The functions that answer GET and HEAD later, by path: they call `answer` once, on any thread, also within the call. Called on
/// the gateway's thread.
using WebLateRoutes =
    std::map<std::string, std::function<void(const WebQuestion&, std::function<void(WebAnswer)> answer)>, std::less<>>;

/// What requests below a path are given to, whatever their method. Called on the gateway's thread.
struct WebResources {
  std::string prefix = {};  // "/v1/"; a path of another kind that begins so goes before
  std::function<void(std::shared_ptr<WebExchange>)> begin = {};
  /// Whether there are any that have not ended. The gateway, once its connections are gone, goes when there are none.
  std::function<bool()> are_open = {};
};

struct WebSocketOptions {
  std::string path;
  std::function<absl::StatusOr<Caller>(const Peer&)> identify;
  WebConversationMaker maker;
  WebOrigins origins = {};                  // of pages that may
  TrustedProxies proxies = {};              // that say for whom they open one
  std::size_t max_sockets = 1000;           // at once
  std::size_t max_sockets_of_client = 250;  // of one caller, or one address where nobody knows who that is
  WebLateRoutes late_routes = {};           // for pages that may open a WebSocket, too
  WebResources resources = {};              // for programs, and these pages
};

struct WebGatewayOptions {
  std::string listen;                 // "host:port"; port 0 = any free one
  std::size_t max_connections = 128;  // that are no WebSockets; for one more, the one goes that has waited longest for a request
  std::chrono::milliseconds time_out{
      10'000};                        // for a request to arrive whole, an answer to be taken, and the next request to come
  std::optional<ServerTls> tls = {};  // with client_authorities, only clients for whom these vouch may open WebSockets
  std::optional<WebSocketOptions> sockets = {};
};

/// HTTP/1.1 with keep-alive, on one thread. Requests have at most 8 KiB of header, and a body only where they are for a resource.
/// Thread-safe.
class WebGateway {
 public:
  /// Listens, or fails with Unavailable (address in use, or not one of this machine's) or InvalidArgument (malformed address, TLS
  /// files).
  static absl::StatusOr<std::unique_ptr<WebGateway>> start(const WebGatewayOptions& options, WebRoutes routes,
                                                           std::shared_ptr<spdlog::logger> log);
  virtual ~WebGateway() = default;  // ends all connections at once

  virtual int port() const = 0;
  /// Encrypts connections from now on with this, where they are encrypted; those that there are stay as they are.
  /// InvalidArgument: with what it was.
  virtual absl::Status replace_tls(const ServerTls& tls) = 0;
  /// Tells the clients of all WebSockets that the server goes, and opens no more. Returns when all have closed, or after
  /// `patience`.
  virtual void close_sockets(std::chrono::milliseconds patience) = 0;
};

}  // namespace curvecast::server
