// What a server may take of its machine's memory, and of a disk instead.
#pragma once

#include <cstdint>

namespace curvecast::server {

struct ServerOptions;

/// Returns the bytes that the process may take: what the options say, or 70 % of what the machine or its container has.
std::uint64_t memory_share(const ServerOptions& options);

/// Returns the bytes that jobs may take together, at this moment: large blocks beyond `memory`, which is memory_share(), lie in a
/// file, for which its disk has to have room. A server does not let its jobs take more of that than as much as its memory, for
/// what works in a file is slow and holds others up; a process that works for its user alone takes what there is.
std::uint64_t memory_with_file(const ServerOptions& options, std::uint64_t memory);

/// Whether there may be other clients than this process. A command that works for itself alone is not to stand back behind the
/// other programs of the machine.
bool has_other_clients(const ServerOptions& options);

}  // namespace curvecast::server
