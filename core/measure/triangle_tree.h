// The nearest triangle of a mesh to any point in space, through a tree of boxes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct NearestFace {
  std::uint32_t face = kNone;
  double distance = std::numeric_limits<double>::infinity();
};

/// Copies what it needs of the mesh. Answers are the same every time. Immutable once built: any number of threads may ask.
class TriangleTree {
 public:
  /// Precondition: the mesh has a triangle.
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Finds the nearest face; of those as near, to rounding, any one. The point is finite.
  NearestFace nearest(const Vec3d& point) const;

  /// Finds the nearest face of every point, on all threads of the arena. `found` has an entry for each. Quickest where points
  /// follow their neighbours.
  void nearest(std::span<const Vec3d> points, std::span<NearestFace> found) const;

 private:
  static constexpr std::size_t kLeafSize = 4;
  static constexpr std::size_t kFanOut = 8;
  using Corners = std::array<Vec3d, 3>;
  struct Found {
    std::size_t place;  // in `faces_`
    double distance;
  };
  struct alignas(64) Boxes {
    double min[3][kFanOut], max[3][kFanOut];  // min > max behind the last child
  };

  void stack_boxes();
  Found search(const Vec3d& point, std::size_t guess) const;

  std::vector<std::uint32_t> faces_;        // in kd_order(): Runs of kLeafSize are the leaves
  std::vector<Corners> corners_;            // of those faces
  std::vector<Boxes> boxes_;                // of eight leaves each, then of eight of those, and so on up to the root
  std::vector<std::uint32_t> level_begin_;  // offsets into boxes_
};

}  // namespace curvecast
