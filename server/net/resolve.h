// What a host's name stands for.
#pragma once

#include <absl/status/statusor.h>
#include <netdb.h>

#include <memory>

#include "server/base/address.h"

namespace curvecast::server {

struct FreeAddresses {
  void operator()(addrinfo* first) const { ::freeaddrinfo(first); }
};
/// A list, never empty.
using AddressList = std::unique_ptr<addrinfo, FreeAddresses>;

/// Looks up all addresses of a host and port, to listen on. Unavailable, with the reason: the name is not known, say.
absl::StatusOr<AddressList> resolve(const Address& address);

}  // namespace curvecast::server
