// A proxy that looks into nothing: what comes goes on, after a header of its own.
#pragma once

#include <string>
#include <thread>
#include <vector>

namespace curvecast::server {

class ProxyRelay {
 public:
  /// Listens on the loopback, and connects each client to `target`, a port of it, to which it first sends `header`. The first
  /// `resets` connections are reset instead.
  explicit ProxyRelay(int target, std::string header = {}, int resets = 0);
  ProxyRelay(const ProxyRelay&) = delete;
  ProxyRelay& operator=(const ProxyRelay&) = delete;
  ~ProxyRelay();

  int port() const { return port_; }

 private:
  void run();

  const int target_;
  const std::string header_;
  int resets_;
  int listener_ = -1, port_ = 0;
  // The thread's alone until it ends.
  std::vector<int> sockets_;
  std::vector<std::thread> threads_;  // one for each direction of each connection
  std::thread thread_;
};

}  // namespace curvecast::server
