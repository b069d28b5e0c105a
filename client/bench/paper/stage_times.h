// Table 1: seconds of the stages.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "client/bench/paper/paper_values.h"
#include "client/bench/paper/ways.h"
#include "core/base/execution_context.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast::cli::bench {

/// Prepares a mesh for `points` jittered points and makes them, several times; returns the fastest of each stage: what else the
/// machine does only adds to it. Errors as of preprocess() and resample().
absl::StatusOr<StageTimes> measure_stages(const MeshFile& file, Way way, std::uint64_t points, int repeats,
                                          const ExecutionContext& context);

}  // namespace curvecast::cli::bench
