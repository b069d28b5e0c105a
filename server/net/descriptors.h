// How many files and sockets this process may have open, and how they are shared out.
#pragma once

#include <cstddef>

namespace curvecast::server {

/// Raises the soft limit of open descriptors to the hard one, where that is allowed, and returns the limit that holds then.
std::size_t raise_descriptor_limit();

/// Parts of the descriptors that a process may have. What is left is for files, for the time it takes to end connections, and for
/// whoever looks whether the server is well.
struct DescriptorShares {
  std::size_t connections = 0;   // of gRPC: a half
  std::size_t sockets = 0;       // WebSockets: an eighth
  std::size_t pages = 0;         // connections of an HTTP port that are no WebSockets: a sixteenth
  std::size_t reserve_from = 0;  // a connection waits for a descriptor below this
};
DescriptorShares share_descriptors(std::size_t limit);

}  // namespace curvecast::server
