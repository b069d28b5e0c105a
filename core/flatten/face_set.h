// Some faces of a mesh, and where each stands among them, without memory in proportion to the whole mesh.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

class FaceSet {
 public:
  /// Keeps a reference to `faces`, which ascend.
  FaceSet(std::span<const std::uint32_t> faces, const TriangleMesh& mesh)
      : faces_(faces), whole_(faces.size() == mesh.face_count()) {}

  /// Returns the number of face f within the set; kNone when the set has no such face.
  std::uint32_t index(std::uint32_t f) const {
    if (whole_) return f;
    const auto found = std::lower_bound(faces_.begin(), faces_.end(), f);
    return found != faces_.end() && *found == f ? static_cast<std::uint32_t>(found - faces_.begin()) : kNone;
  }
  /// Returns the number of halfedge h within the set; kNone for kNone, and where the set does not have its face.
  std::uint32_t halfedge(std::uint32_t h) const {
    const std::uint32_t f = h == kNone ? kNone : index(h / 3);
    return f == kNone ? kNone : 3 * f + h % 3;
  }

 private:
  std::span<const std::uint32_t> faces_;
  bool whole_;
};

}  // namespace curvecast
