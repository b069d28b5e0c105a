// The name of the other end of a connection.
#pragma once

#include <string>

struct sockaddr;

namespace curvecast::server {

/// Writes an address as gRPC does ("ipv4:127.0.0.1:4711", "ipv6:%5B::1%5D:4711"), so that a client is one whichever way it comes.
/// "unknown:0" for what is no address of IP.
std::string peer_name(const sockaddr* address);

}  // namespace curvecast::server
