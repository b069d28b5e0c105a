// Connections of trusted proxies, which may begin with a header that says whose they are.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/net/proxy_header.h"

namespace curvecast::server {

/// How long a proxy's first bytes may take; then a connection that has brought none is taken as it is.
inline constexpr std::chrono::seconds kProxyPatience{5};
/// How often to look whether the rest of a header has come.
inline constexpr std::chrono::milliseconds kProxyLook{10};

/// Takes the header with which a socket that does not block begins; nothing while it is to be waited for. At `end`, a connection
/// that has brought nothing has none, and a part of a header is a broken one.
std::optional<ProxyHeader> take_proxy_header(int descriptor, std::chrono::steady_clock::time_point end);

/// Holds connections until their headers have come: see proxy_header.h. A proxy sends its header at once, so most never wait.
/// Not thread-safe. Closes those that it still has when it goes.
class ProxyQueue {
 public:
  struct Connection {
    int listener;  // the descriptor that it came by
    int descriptor;
    std::string peer;  // the proxy
  };
  /// `client`: for whom the proxy calls; empty: it does not say.
  using Give = std::function<void(const Connection& connection, const std::string& client)>;

  ProxyQueue() = default;
  ProxyQueue(const ProxyQueue&) = delete;
  ProxyQueue& operator=(const ProxyQueue&) = delete;
  ~ProxyQueue();

  /// Gives the connection away at once, or once serve() sees the rest of its header. The oldest of too many is closed.
  void add(Connection connection, const Give& give);
  /// Gives away those whose header has come, or of which nothing has for too long; closes those whose header is broken.
  void serve(const Give& give);
  bool is_empty() const { return waiting_.empty(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    Connection connection;
    Clock::time_point end;
  };
  /// Whether the connection has gone, one way or the other.
  static bool meet(const Waiting& waiting, const Give& give);

  std::vector<Waiting> waiting_;  // by age
};

}  // namespace curvecast::server
