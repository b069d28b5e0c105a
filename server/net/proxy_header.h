// The header of the PROXY protocol, with which a proxy that does not look into connections says whose one is: HAProxy 2.6,
// doc/proxy-protocol.txt, versions 1 and 2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace curvecast::server {

struct ProxyHeader {
  enum class State {
    kNone,    // the bytes are something else
    kPart,    // of a header, perhaps: so far there are `size` bytes
    kWhole,   // it has `size` bytes
    kBroken,  // or too long
  };
  State state = State::kNone;
  std::size_t size = 0;
  std::string client = {};  // as gRPC writes it ("ipv4:10.0.0.1:4711"); empty: the proxy speaks for itself, or names nobody
};

/// The most bytes of a header, with what proxies add to it, that we take.
inline constexpr std::size_t kMostProxyHeader = 4096;

/// Reads what a connection begins with.
ProxyHeader read_proxy_header(std::span<const std::uint8_t> bytes);

/// Takes the header from a socket that does not block, and leaves there what follows. kPart: of it, `size` bytes have come so
/// far, or none. kNone, too, for a connection that has ended.
ProxyHeader take_proxy_header(int descriptor);

}  // namespace curvecast::server
