// Makes blue noise of an equalised point set: points move along the surface to the centres of their Voronoi cells, and those that
// stay too near to others part. Source: Lloyd, "Least squares quantization in PCM" (1982), with cells that follow the density.
#pragma once

#include <absl/status/status.h>

#include "core/base/execution_context.h"
#include "core/curve/curve_base.h"
#include "core/sample/point_set.h"

namespace curvecast {

inline constexpr int kMaxRelaxationRounds = 100;

/// How far a point moves from where it was, in spacings: the distance of neighbours in the densest packing of its density.
inline constexpr double kMostMove = 1.15;

/// Moves every point `rounds` times (0 .. kMaxRelaxationRounds), none by more than kMostMove in all: so the set stays as even at
/// large as it was. Sets positions, places, normals and, where there are any, colours, and has_moved; radii and vertices stay.
/// Points matter to each other only where the surface faces about the same way. `base`: what the points' curve lies on. The same
/// for any number of threads of the arena; quickest where the points stand in the order of the curve. Charged to context.limit.
/// Errors: those of surface_mesh() and of the base's status(); Cancelled; ResourceExhausted as of MemoryClaim; DeadlineExceeded
/// once the limit is spent. The points mean nothing then. Precondition: every point has a place.
absl::Status move_apart(const CurveBase& base, int rounds, PointSet& points, const ExecutionContext& context = {});

/// The same on the mesh that `data` is of, whose neighbours are known.
absl::Status move_apart(const TriangleMesh& mesh, const SurfaceData& data, int rounds, PointSet& points,
                        const ExecutionContext& context = {});

}  // namespace curvecast
