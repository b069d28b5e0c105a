// What the progressive sampler costs: its ranks once, then each step of a camera.
#pragma once

#include <absl/status/status.h>

#include <memory>

#include "client/bench/sample_bench.h"
#include "core/base/execution_context.h"
#include "core/curve/leaf_surface.h"
#include "core/curve/surface_curve.h"
#include "core/density/camera.h"

namespace curvecast::cli::bench {

/// On an orbit about the mesh, some degrees on.
Camera orbit_camera(const SurfaceCurve& curve, double degrees);

/// Appends rows to `report`; `read_seconds` is what they are compared with.
absl::Status bench_ranks(const std::shared_ptr<const LeafSurface>& surface, const SampleBenchOptions& options,
                         double read_seconds, const ExecutionContext& context, BenchReport& report);

}  // namespace curvecast::cli::bench
