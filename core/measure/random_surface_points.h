// Random points of a surface: the measure of all others.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct SurfacePoints {
  std::vector<Vec3d> positions;      // N, in the file's units
  std::vector<std::uint32_t> faces;  // N, on which they lie
};

/// Independent points, uniform in area, point i the same for any n. Precondition: the mesh has an area.
/// Source: Turk, "Generating random points in triangles" (Graphics Gems, 1990).
SurfacePoints random_surface_points(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed);

}  // namespace curvecast
