#include "server/net/port_listener.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/string_view.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "server/base/status_from_exceptions.h"
#include "server/net/peer_name.h"
#include "server/net/proxy_queue.h"
#include "server/net/resolve.h"

namespace curvecast::server {
namespace {

constexpr int kPauseMs = 100;              // where there are no descriptors left, until the next try
constexpr unsigned kGoneAfterMs = 10'000;  // a connection whose other side acknowledges nothing for so long

void switch_on(int descriptor, int level, int option, unsigned value = 1) {
  ::setsockopt(descriptor, level, option, &value, sizeof value);
}

/// Where an address has its port, in the byte order of the network.
in_port_t& port_in(sockaddr_storage& address) {
  return address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(address).sin6_port
                                       : reinterpret_cast<sockaddr_in&>(address).sin_port;
}

int port_of(int descriptor) {
  sockaddr_storage address = {};
  socklen_t size = sizeof address;
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(port_in(address));
}

/// A socket that listens on an address, on another port where that is not 0; or -1, and errno tells why.
int listen_on(const addrinfo& info, int port) {
  sockaddr_storage address = {};
  std::memcpy(&address, info.ai_addr, info.ai_addrlen);
  if (port != 0) port_in(address) = htons(static_cast<std::uint16_t>(port));
  const int descriptor = ::socket(info.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return -1;
  switch_on(descriptor, SOL_SOCKET, SO_REUSEADDR);  // by connections that have just gone
  // What connections inherit.
  switch_on(descriptor, IPPROTO_TCP, TCP_NODELAY);
  switch_on(descriptor, IPPROTO_TCP, TCP_USER_TIMEOUT, kGoneAfterMs);
  if (info.ai_family == AF_INET6) switch_on(descriptor, IPPROTO_IPV6, IPV6_V6ONLY, 0);  // [::] is for all
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), info.ai_addrlen) == 0 &&
      ::listen(descriptor, SOMAXCONN) == 0) {
    return descriptor;
  }
  const int error = errno;
  ::close(descriptor);
  errno = error;
  return -1;
}

bool is_lack(int error) { return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM; }

}  // namespace

absl::StatusOr<std::unique_ptr<PortListener>> PortListener::bind(const std::string& address) {
  return status_from_exceptions([&]() -> absl::StatusOr<std::unique_ptr<PortListener>> {
    std::unique_ptr<PortListener> listener(new PortListener);
    if (absl::Status status = listener->open(address); !status.ok()) return status;
    return listener;
  });
}

PortListener::~PortListener() { close(); }

absl::Status PortListener::open(const std::string& address) {
  const absl::StatusOr<Address> parsed = parse_address(address);
  if (!parsed.ok()) return parsed.status();
  const auto fail = [&](absl::string_view why) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", address, ": ", why));
  };
  const absl::StatusOr<AddressList> found = resolve(*parsed);
  if (!found.ok()) return fail(found.status().message());
  int error = 0;
  for (const addrinfo* info = found->get(); info != nullptr; info = info->ai_next) {
    const int descriptor = listen_on(*info, port_);
    if (descriptor < 0) {
      error = errno;
      if (error == EADDRINUSE) return fail(std::strerror(error));  // else some may lack, as IPv6 on some machines
      continue;
    }
    descriptors_.push_back(descriptor);
    if (port_ == 0) port_ = port_of(descriptor);
  }
  return descriptors_.empty() ? fail(std::strerror(error)) : absl::OkStatus();
}

void PortListener::accept(Take take, IsProxy is_proxy) {
  thread_ = std::thread([this, take = std::move(take), is_proxy = std::move(is_proxy)] { run(take, is_proxy); });
}

void PortListener::run(const Take& take, const IsProxy& is_proxy) const {
  std::vector<pollfd> waits = {{wake_up_.descriptor(), POLLIN, 0}};
  for (const int descriptor : descriptors_) waits.push_back({descriptor, POLLIN, 0});
  bool lacks = false;
  // What fails for one connection, be it for lack of memory, is no reason not to take the next.
  const ProxyQueue::Give give = [&](const ProxyQueue::Connection& connection, const std::string& client) {
    const absl::Status given = status_from_exceptions([&] {
      take(connection.listener, connection.descriptor, connection.peer, client);
      return absl::OkStatus();
    });
    lacks = lacks || !given.ok();
  };
  ProxyQueue proxies;
  while (true) {
    if (lacks) {
      ::poll(waits.data(), 1, kPauseMs);
    } else {
      ::poll(waits.data(), waits.size(), proxies.is_empty() ? -1 : static_cast<int>(kProxyLook.count()));
    }
    if ((waits[0].revents & POLLIN) != 0) return;
    lacks = false;
    proxies.serve(give);
    for (std::size_t i = 1; i < waits.size(); ++i) {
      sockaddr_storage peer = {};
      socklen_t size = sizeof peer;
      auto* const address = reinterpret_cast<sockaddr*>(&peer);
      const int descriptor = ::accept4(waits[i].fd, address, &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
      if (descriptor < 0) {
        lacks = lacks || is_lack(errno);
        continue;
      }
      ProxyQueue::Connection connection = {waits[i].fd, descriptor, peer_name(address)};
      if (is_proxy && is_proxy(connection.peer)) {
        proxies.add(std::move(connection), give);
      } else {
        give(connection, "");
      }
    }
  }
}

void PortListener::close() {
  wake_up_.ring();
  if (thread_.joinable()) thread_.join();
  for (const int descriptor : descriptors_) ::close(descriptor);
  descriptors_.clear();
}

}  // namespace curvecast::server
