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
  std::uint32_t index(std::uint32_t f) const { return whole_ ? f : find(f, 0, faces_.size()); }
  /// Does the same, fast where the face's number is near `hint`, which is below the number of faces.
  std::uint32_t index(std::uint32_t f, std::uint32_t hint) const {
    if (whole_) return f;
    std::size_t begin = hint, end = hint, step = 1;  // the face is in [begin, end), if anywhere
    if (faces_[hint] <= f) {
      while (end < faces_.size() && faces_[end] <= f) begin = end, end += step, step *= 2;
      end = std::min(end, faces_.size());
    } else {
      while (begin > 0 && faces_[begin] > f) end = begin, begin -= std::min(begin, step), step *= 2;
    }
    return find(f, begin, end);
  }
  /// Returns the number of halfedge h within the set; kNone for kNone, and where the set does not have its face. `hint`: of
  /// index().
  std::uint32_t halfedge(std::uint32_t h, std::uint32_t hint) const {
    const std::uint32_t f = h == kNone ? kNone : index(h / 3, hint);
    return f == kNone ? kNone : 3 * f + h % 3;
  }

 private:
  /// The number of face f, if it is one of [begin, end).
  std::uint32_t find(std::uint32_t f, std::size_t begin, std::size_t end) const {
    const std::span<const std::uint32_t> some = faces_.subspan(begin, end - begin);
    const auto found = std::lower_bound(some.begin(), some.end(), f);
    return found != some.end() && *found == f ? static_cast<std::uint32_t>(begin + (found - some.begin())) : kNone;
  }

  std::span<const std::uint32_t> faces_;
  bool whole_;
};

}  // namespace curvecast
