#include "server/net/resolve.h"

#include <absl/strings/str_cat.h>
#include <sys/socket.h>

namespace curvecast::server {

absl::StatusOr<AddressList> resolve(const Address& address) {
  addrinfo hints = {};
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(address.host.c_str(), absl::StrCat(address.port).c_str(), &hints, &found);
  if (error != 0) return absl::UnavailableError(::gai_strerror(error));
  return AddressList(found);
}

}  // namespace curvecast::server
