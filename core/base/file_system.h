// What can be expected of the file system that a file is on.
#pragma once

#include <cstdint>

namespace curvecast {

/// Whether an open file is on a disk of this machine, or in its memory: its pages, once mapped, are there until somebody shortens
/// it. On file systems of a network, or that a program serves, another machine's or the program's end takes them away. True where
/// the system does not say.
bool is_on_local_disk(int descriptor);

/// The same of a file system of this type, as of statfs().
bool is_local_type(std::uint32_t type);

}  // namespace curvecast
