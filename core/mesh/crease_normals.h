// Normals beside creases: edges so sharp that no smooth surface is meant. Each side of a crease has normals of its own, as a face
// of a box has one that does not lean towards its neighbours'.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/triangle_mesh.h"
#include "core/mesh/vertex_fans.h"

namespace curvecast {

/// Faces whose normals are further apart than this meet at a crease, where nobody says otherwise.
inline constexpr double kCreaseDegrees = 40;

/// The normal of a vertex within one part of the faces around it.
struct CreaseNormal {
  std::uint32_t vertex;
  Vec3f normal;  // unit length, angle-weighted mean of the part's faces
};

/// A face with a corner that has a normal other than its vertex.
struct CreaseFace {
  std::uint32_t face;
  std::array<std::uint32_t, 3>
      normals;  // of its corners: numbers of CreaseNormals::normals, or kNone where it is the vertex's own
};

struct CreaseNormals {
  std::vector<CreaseNormal> normals;  // in order of vertex
  std::vector<CreaseFace> faces;      // in order of face
};

/// The same where it lies, in memory or in a mapped file, which outlives it.
struct CreaseView {
  CreaseView() = default;
  CreaseView(const CreaseNormals& creases) : normals(creases.normals), faces(creases.faces) {}  // NOLINT: it is one
  CreaseView(std::span<const CreaseNormal> of_vertices, std::span<const CreaseFace> of_faces)
      : normals(of_vertices), faces(of_faces) {}

  std::span<const CreaseNormal> normals;
  std::span<const CreaseFace> faces;
};

/// Says of each halfedge whether the normals of the faces beside it have a smaller cosine; 0 on borders. Of some it is 0 once the
/// context is cancelled.
std::vector<std::uint8_t> find_creases(const TriangleMesh& mesh, double cosine, const ExecutionContext& context);

/// The normals of all vertices at which creases divide the faces around them into two parts or more. A crease that ends at a
/// vertex inside the surface divides nothing there. Some are missing once the context is cancelled.
///
/// `degrees`, 0 .. 180: faces whose normals are further apart, by more than what floats tell, meet at a crease. At 0 all edges
/// are creases, at 180 none are.
CreaseNormals crease_normals(const TriangleMesh& mesh, double degrees = kCreaseDegrees);
CreaseNormals crease_normals(const TriangleMesh& mesh, double degrees, const VertexFans& fans, const ExecutionContext& context);

}  // namespace curvecast
