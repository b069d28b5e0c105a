// Simplification by meshoptimizer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// The vertices of all triangles, one after the other.
std::vector<std::uint32_t> corners_of(const TriangleMesh& mesh);

/// Leaves about so many triangles of those that are there, whatever the error. Source: Garland, Heckbert, "Surface simplification
/// using quadric error metrics" (1997), as meshoptimizer has it, on one thread.
void simplify(std::span<const Vec3f> positions, std::vector<std::uint32_t>& corners, std::size_t faces);

}  // namespace curvecast::cli::bench
