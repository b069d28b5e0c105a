// Draws the triangles of a mesh, to hold pictures of points against.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/mesh/triangle_mesh.h"
#include "core/render/render_camera.h"

namespace curvecast::cli::bench {

struct MeshPicture {
  Image image;                        // shaded by the faces' normals, with a light at the eye, on a pale background
  std::vector<std::uint8_t> covered;  // by pixel, in rows from top to bottom: 1 where the mesh is seen
};

/// Draws a mesh through the middles of width x height pixels, by a depth buffer. Both sides of faces are seen.
MeshPicture draw_mesh(const TriangleMesh& mesh, const RenderCamera& camera, int width, int height);

/// Draws a mesh with the sides of its triangles as thin lines, without those that are hidden, smooth: several samples for each
/// pixel.
Image draw_wireframe(const TriangleMesh& mesh, const RenderCamera& camera, int width, int height);

}  // namespace curvecast::cli::bench
