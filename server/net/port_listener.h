// A TCP port that goes on listening whatever happens.
#pragma once

#include <absl/status/statusor.h>

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/net/wake_up.h"

namespace curvecast::server {

/// Listens, and gives its connections to somebody, on a thread of its own. Where the process has no descriptors left it waits
/// until there are some.
class PortListener {
 public:
  /// Takes a connection, with its socket, which does not block. `listener` is the descriptor that it came by. `client`: for whom
  /// the peer, a proxy, has opened it; empty: for itself, or it does not say.
  using Take = std::function<void(int listener, int descriptor, const std::string& peer, const std::string& client)>;
  /// Whether a peer is a proxy that may say so: see proxy_header.h. Empty: none is.
  using IsProxy = std::function<bool(const std::string& peer)>;

  /// Binds "host:port", every address that the host's name stands for; port 0 is any free one. Unavailable: an address is in use
  /// or not one of this machine's. InvalidArgument: it is none.
  static absl::StatusOr<std::unique_ptr<PortListener>> bind(const std::string& address);
  PortListener(const PortListener&) = delete;
  PortListener& operator=(const PortListener&) = delete;
  ~PortListener();

  int port() const { return port_; }
  /// A descriptor whose address is listened on.
  int descriptor() const { return descriptors_.front(); }
  /// Begins to accept connections, for which clients may have waited since bind(). Called once.
  void accept(Take take, IsProxy is_proxy = {});
  /// Accepts no more, and refuses who tries. Idempotent; not thread-safe.
  void close();

 private:
  PortListener() = default;
  absl::Status open(const std::string& address);
  void run(const Take& take, const IsProxy& is_proxy) const;

  std::vector<int> descriptors_;
  int port_ = 0;
  const WakeUp wake_up_;
  std::thread thread_;
};

}  // namespace curvecast::server
