#include "tests/server/net/proxy_relay.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace curvecast::server {
namespace {

sockaddr_in loopback(int port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// Until one side has ended; then both have.
void pump(int from, int to) {
  std::array<char, 16384> bytes = {};
  for (ssize_t count = 0; (count = ::recv(from, bytes.data(), bytes.size(), 0)) > 0;) {
    for (ssize_t sent = 0; sent < count;) {
      const ssize_t more = ::send(to, bytes.data() + sent, static_cast<std::size_t>(count - sent), MSG_NOSIGNAL);
      if (more <= 0) break;
      sent += more;
    }
  }
  for (const int socket : {from, to}) ::shutdown(socket, SHUT_RDWR);
}

}  // namespace

ProxyRelay::ProxyRelay(int target, std::string header, int resets)
    : target_(target), header_(std::move(header)), resets_(resets), listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(::listen(listener_, SOMAXCONN), 0);
  EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { run(); });
}

ProxyRelay::~ProxyRelay() {
  ::shutdown(listener_, SHUT_RDWR);
  thread_.join();
  for (const int socket : sockets_) ::shutdown(socket, SHUT_RDWR);
  for (std::thread& thread : threads_) thread.join();
  for (const int socket : sockets_) ::close(socket);
  ::close(listener_);
}

void ProxyRelay::run() {
  for (int client = -1; (client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
    if (resets_ > 0) {
      --resets_;
      const linger at_once = {.l_onoff = 1, .l_linger = 0};
      EXPECT_EQ(::setsockopt(client, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once), 0);
      ::close(client);
      continue;
    }
    const int server = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const sockaddr_in address = loopback(target_);
    sockets_.insert(sockets_.end(), {client, server});
    if (::connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::send(server, header_.data(), header_.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(header_.size())) {
      ::shutdown(client, SHUT_RDWR);
      continue;
    }
    threads_.emplace_back(pump, client, server);
    threads_.emplace_back(pump, server, client);
  }
}

}  // namespace curvecast::server
