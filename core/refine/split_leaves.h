// Divides some leaves of a curve and leaves the others as they are: local refinement (paper, section 3.2).
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>

#include "core/base/execution_context.h"
#include "core/curve/curve_base.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// Makes the next revision, with each leaf l divided levels[l] times (L entries; level + levels[l] <= kMaxLevel). Other leaves
/// keep all their columns to the bit. The new ones are mapped as in a first build, and share the area element of the leaf that
/// they come from in proportion to the surface under each. The blocks are left empty. The same for any number of threads.
/// Cancelled when the context says so; ResourceExhausted where new leaves meet triangles, or curve vertices come out, more than
/// 2^32 times.
absl::StatusOr<SurfaceCurve> split_leaves(const CurveBase& base, const SurfaceCurve& curve, std::span<const std::uint8_t> levels,
                                          const ExecutionContext& context = {});

}  // namespace curvecast
