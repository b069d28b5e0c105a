#include "server/net/port_probe.h"

#include <absl/cleanup/cleanup.h>
#include <netinet/in.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace curvecast::server {

PortProbe::PortProbe(int listener, const Options& options) : options_(options) {
  ::getsockname(listener, reinterpret_cast<sockaddr*>(&address_), &address_size_);
  if (address_.ss_family == AF_INET6) {
    auto& six = reinterpret_cast<sockaddr_in6&>(address_).sin6_addr;
    if (IN6_IS_ADDR_UNSPECIFIED(&six)) six = in6addr_loopback;
  } else {
    auto& four = reinterpret_cast<sockaddr_in&>(address_).sin_addr;
    if (four.s_addr == INADDR_ANY) four.s_addr = htonl(INADDR_LOOPBACK);
  }
  thread_ = std::thread([this] { run(); });
}

PortProbe::~PortProbe() {
  wake_up_.ring();
  thread_.join();
}

bool PortProbe::answers() const { return Clock::now() - answered_.load() < options_.patience; }

void PortProbe::run() {
  pollfd end = {wake_up_.descriptor(), POLLIN, 0};
  do {
    if (ask()) answered_ = Clock::now();
  } while (::poll(&end, 1, static_cast<int>(options_.interval.count())) == 0);
}

bool PortProbe::ask() const {
  const int descriptor = ::socket(address_.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return false;
  const absl::Cleanup close = [descriptor] { ::close(descriptor); };
  const linger at_once = {.l_onoff = 1, .l_linger = 0};  // leaves nothing behind that waits for stray packets
  ::setsockopt(descriptor, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  const Clock::time_point deadline = Clock::now() + options_.patience / 2;
  if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address_), address_size_) != 0) {
    if (errno != EINPROGRESS || !wait(descriptor, POLLOUT, deadline)) return false;
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0) return false;
  }
  ::shutdown(descriptor, SHUT_WR);
  return wait(descriptor, POLLIN, deadline);  // bytes, or the end
}

bool PortProbe::wait(int descriptor, short events, Clock::time_point deadline) const {
  std::array<pollfd, 2> waits = {{{wake_up_.descriptor(), POLLIN, 0}, {descriptor, events, 0}}};
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    const int ready = ::poll(waits.data(), waits.size(), static_cast<int>(std::max<std::int64_t>(0, left)));
    if (ready < 0 && errno == EINTR) continue;
    return ready > 0 && waits[0].revents == 0;
  }
}

}  // namespace curvecast::server
