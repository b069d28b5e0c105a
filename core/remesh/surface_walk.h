// The nearest place of a surface to a point, found from a place near it.
#pragma once

#include <cstdint>

#include "core/mesh/triangle_mesh.h"
#include "core/mesh/vertex_fans.h"

namespace curvecast {

/// A place on a face: weights of its corners, and where that is.
struct WalkPlace {
  std::uint32_t face = kNone;
  double weight_1 = 0, weight_2 = 0;  // of the second and third corner
  Vec3d position = Vec3d::Zero();
};

/// Must not outlive the mesh. Any number of threads may ask.
class SurfaceWalk {
 public:
  explicit SurfaceWalk(const TriangleMesh& mesh) : mesh_(mesh), fans_(mesh) {}

  const VertexFans& fans() const { return fans_; }
  std::size_t face_count() const { return mesh_.face_count(); }
  /// Unit normal of a face; zero where it has no area.
  Vec3d normal(std::uint32_t face) const;

  WalkPlace place(std::uint32_t face, double weight_1, double weight_2) const;

  /// Goes from face to face, each nearer to the point than the one before, until none around is nearer. What lies on another
  /// sheet of the surface is never found, however near.
  WalkPlace nearest(std::uint32_t face, const Vec3d& point) const;

 private:
  const TriangleMesh& mesh_;
  VertexFans fans_;
};

}  // namespace curvecast
