// The client of a connection that comes by a proxy.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace curvecast::server {

/// Immutable: thread-safe.
class TrustedProxies {
 public:
  /// Networks as "10.0.0.0/8" or "fd00::/8", and single addresses. InvalidArgument names the one that is wrong.
  static absl::StatusOr<TrustedProxies> parse(const std::vector<std::string>& networks);

  TrustedProxies() = default;  // none

  /// Whether `peer`, the other end of a connection as gRPC writes it, is one of these proxies.
  bool trusts(std::string_view peer) const;
  /// Names the client for whom `peer`, the other end of a connection as gRPC writes it, calls: the last address in its
  /// `x-forwarded-for` headers that is not itself one of these proxies, with the port of the connection. What stands before an
  /// address that is none, anybody may have written: the last one after it counts. Nothing where the peer is none of these
  /// proxies, or names nobody.
  std::optional<std::string> client_of(std::string_view peer, const std::vector<std::string_view>& forwarded_for) const;

 private:
  using Bytes = std::array<std::uint8_t, 16>;  // IPv4 as IPv6 writes it: ::ffff:10.0.0.1
  struct Network {
    Bytes address;
    int bits;
  };
  bool contain(const Bytes& address) const;

  std::vector<Network> networks_;
};

}  // namespace curvecast::server
