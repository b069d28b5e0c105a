// Normals and curvatures at the vertices. Source: Meyer, Desbrun, Schröder, Barr, "Discrete differential-geometry operators for
// triangulated 2-manifolds" (2002).
#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct DifferentialGeometry {
  std::vector<Vec3f> normals;         // V, unit length, angle-weighted mean of the faces'
  std::vector<float> curvature_min;   // V, smaller principal curvature, 1/unit; positive where the surface is convex
  std::vector<float> curvature_max;   // V, larger principal curvature, 1/unit
  std::vector<Vec3f> directions_max;  // V, see principal_directions
};

/// Border vertices have no curvature of their own and take the mean of their inner neighbours'.
DifferentialGeometry differential_geometry(const TriangleMesh& mesh);

/// Returns the unit normal of a face.
Vec3f face_normal(const TriangleMesh& mesh, std::uint32_t f);

}  // namespace curvecast
