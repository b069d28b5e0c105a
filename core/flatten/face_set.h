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

  /// The place of face f in the set; kNone when it is not there.
  std::uint32_t index(std::uint32_t f) const {
    if (whole_) return f;
    const auto found = std::lower_bound(faces_.begin(), faces_.end(), f);
    return found != faces_.end() && *found == f ? static_cast<std::uint32_t>(found - faces_.begin()) : kNone;
  }
  /// The same for a halfedge: of the set's own numbering; kNone for kNone and where its face is not in the set.
  std::uint32_t halfedge(std::uint32_t h) const {
    const std::uint32_t f = h == kNone ? kNone : index(h / 3);
    return f == kNone ? kNone : 3 * f + h % 3;
  }

 private:
  std::span<const std::uint32_t> faces_;
  bool whole_;
};

}  // namespace curvecast
