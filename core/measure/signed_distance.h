// How far places in space are from a closed surface, and on which side. Source: Baerentzen and Aanaes, "Signed distance
// computation using the angle weighted pseudonormal" (2005).
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/measure/triangle_tree.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Immutable: any number of threads may ask. The mesh outlives it.
class SignedDistance {
 public:
  /// FailedPrecondition: the mesh has borders, and so no inside.
  static absl::StatusOr<SignedDistance> of(const TriangleMesh& mesh);

  /// Finds the distance of every point, below 0 inside, in the mesh's units. What is inside is told by the nearest face: where
  /// parts of a mesh pass through each other, by the part that is nearer. `distances` has an entry for each point. On all threads
  /// of the arena. Cancelled.
  absl::Status find(std::span<const Vec3d> points, std::span<double> distances, const ExecutionContext& context = {}) const;

 private:
  explicit SignedDistance(const TriangleMesh& mesh);
  double sign(const Vec3d& point, std::uint32_t face) const;

  const TriangleMesh* mesh_;
  TriangleTree tree_;
  std::vector<Vec3d> vertex_normals_;  // V: sums of the faces' unit normals times their angles
  double outwards_ = 1;                // -1: the mesh is inside out
};

}  // namespace curvecast
