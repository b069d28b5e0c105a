// Says how far a curve is too coarse for a density and a number of points (paper, sections 3.2 and 4.5).
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/density/density.h"

namespace curvecast {

/// The load of a curve vertex is the number of curve vertices that ought to stand in its place: omega times the points that are
/// expected on it. A curve built for N points has loads up to 1 at its base density, most of them lower, because levels are
/// whole numbers. A curve counts as too coarse where a load exceeds this: less than one whole level is what omega is there for,
/// and a whole surface seen from afar (half of it unseen, most of the points towards the silhouette) is still within it.
inline constexpr double kMaxVertexLoad = 4;

/// A number of points that a client wanted to take from a curve, and their density.
struct CurveDemand {
  std::uint64_t points = 0;
  Density density;
};

/// Raises each load[l] (L entries) to that of the demand. Errors as of evaluate_density; a density that is zero everywhere asks
/// for nothing.
absl::Status raise_vertex_loads(const SurfaceCurve& curve, const CurveDemand& demand, double omega, std::span<float> load,
                                const ExecutionContext& context = {});

struct MissingLevels {
  std::vector<std::uint8_t> levels;  // L: by how many levels each leaf has to be divided
  double divisor = 1;                // above 1: by this all loads were lowered to stay within the limit
};

/// Finds the levels that make every load at most 1, as far as keys go and at most `max_vertices` curve vertices come out: where
/// they would be more, all loads are lowered evenly.
MissingLevels missing_levels(const SurfaceCurve& curve, std::span<const float> load, std::uint64_t max_vertices);

}  // namespace curvecast
