// The most memory that this process has held, counted anew whenever wanted.
#pragma once

#include <cstdint>

namespace curvecast::cli::bench {

/// Gives free memory back to the system and starts counting anew; false where the system does not let a process do that.
bool reset_peak_memory();

/// Resident bytes at the highest point since the reset (VmHWM): of the whole process, all that it holds.
std::uint64_t peak_memory();

}  // namespace curvecast::cli::bench
