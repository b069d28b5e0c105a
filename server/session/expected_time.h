// How long a session will take to be made, roughly: short ones go first.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/pipeline/pipeline.h"

namespace curvecast::server {

/// Returns about how long preprocess() takes on two cores, for a mesh file of so many bytes. The order of jobs hangs on it, and
/// when one counts as overdue; no more.
std::chrono::nanoseconds expected_time(std::uint64_t mesh_bytes, const PreprocessOptions& options);

}  // namespace curvecast::server
