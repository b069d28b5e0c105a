#include "server/net/loopback.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include "server/net/resolve.h"

namespace curvecast::server {
namespace {

bool is_loopback(const sockaddr& address) {
  constexpr in_addr_t kNet = 0x7f000000, kMask = 0xff000000;  // 127.0.0.0/8
  if (address.sa_family == AF_INET) {
    return (ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr) & kMask) == kNet;
  }
  return IN6_IS_ADDR_LOOPBACK(&reinterpret_cast<const sockaddr_in6&>(address).sin6_addr) != 0;
}

}  // namespace

bool is_loopback(const std::string& address) {
  const absl::StatusOr<Address> parsed = parse_address(address);
  if (!parsed.ok()) return true;
  const absl::StatusOr<AddressList> found = resolve(*parsed);
  if (!found.ok()) return true;
  for (const addrinfo* info = found->get(); info != nullptr; info = info->ai_next) {
    if (!is_loopback(*info->ai_addr)) return false;
  }
  return true;
}

}  // namespace curvecast::server
