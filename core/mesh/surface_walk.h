// Ways along a surface: to the place nearest to a point, found from a place near it, and straight on.
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

  /// Where a walk ends.
  struct End {
    WalkPlace place;
    std::uint32_t border = kNone;  // the halfedge at which it ended before it was over
  };
  /// Goes straight on along the surface, over edges as if the faces beside them were one plane, as far as the part of `step` in
  /// the first face's plane is long, but no farther than to a border, or to a face without an area. Source: Polthier, Schmies,
  /// "Straightest geodesics on polyhedral surfaces" (1998).
  End straight(const WalkPlace& from, const Vec3d& step) const;

 private:
  const TriangleMesh& mesh_;
  VertexFans fans_;
};

}  // namespace curvecast
