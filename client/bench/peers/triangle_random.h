// Random points triangle by triangle: what the paper compares its points with (section 4.2).
#pragma once

#include <cstdint>

#include "core/measure/random_surface_points.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// Returns n points, face by face: in a face with the share a of the area n a of them, rounded down or up, at random places.
/// Which faces have one more is chosen at random, with the chance of what rounding down took from each, so that there are n in
/// all. Precondition: the mesh has an area.
SurfacePoints triangle_random_points(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed);

}  // namespace curvecast::cli::bench
