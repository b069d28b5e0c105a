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

/// Returns the place of a face that two numbers in [0, 1) choose: uniform in area where they are random.
/// Source: Turk, "Generating random points in triangles" (Graphics Gems, 1990).
Vec3d place_in_face(const TriangleMesh& mesh, std::uint32_t face, double first, double second);

/// Independent points, uniform in area, point i the same for any n. Precondition: the mesh has an area.
SurfacePoints random_surface_points(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed);

}  // namespace curvecast
