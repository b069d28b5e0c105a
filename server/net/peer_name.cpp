#include "server/net/peer_name.h"

#include <absl/strings/str_cat.h>
#include <arpa/inet.h>
#include <netinet/in.h>

#include <array>

namespace curvecast::server {

std::string peer_name(const sockaddr* address) {
  std::array<char, INET6_ADDRSTRLEN> host = {};
  const auto write = [&](int family, const void* bytes) { ::inet_ntop(family, bytes, host.data(), host.size()); };
  if (address->sa_family == AF_INET) {
    const auto* const four = reinterpret_cast<const sockaddr_in*>(address);
    write(AF_INET, &four->sin_addr);
    return absl::StrCat("ipv4:", host.data(), ":", ntohs(four->sin_port));
  }
  if (address->sa_family != AF_INET6) return "unknown:0";
  const auto* const six = reinterpret_cast<const sockaddr_in6*>(address);
  if (IN6_IS_ADDR_V4MAPPED(&six->sin6_addr)) {
    write(AF_INET, &six->sin6_addr.s6_addr[12]);
    return absl::StrCat("ipv4:", host.data(), ":", ntohs(six->sin6_port));
  }
  write(AF_INET6, &six->sin6_addr);
  const std::string scope = six->sin6_scope_id == 0 ? "" : absl::StrCat("%25", six->sin6_scope_id);
  return absl::StrCat("ipv6:%5B", host.data(), scope, "%5D:", ntohs(six->sin6_port));
}

}  // namespace curvecast::server
