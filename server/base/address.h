// The address that a server listens on, as users write it.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>

namespace curvecast::server {

/// An address to listen on.
struct Address {
  std::string host;        // a name or a number, without the brackets of "[::1]"
  std::uint16_t port = 0;  // 0: any free one
};

/// Reads "HOST:PORT" or "[HOST]:PORT". InvalidArgument says what to write instead.
absl::StatusOr<Address> parse_address(const std::string& text);

}  // namespace curvecast::server
