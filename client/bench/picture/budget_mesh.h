// What a user would send instead of points: the mesh, simplified, in Draco's form.
// Source: Garland, Heckbert, "Surface simplification using quadric error metrics" (1997), as meshoptimizer has it.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "client/bench/picture/shaded_mesh.h"
#include "core/base/execution_context.h"

namespace curvecast::cli::bench {

struct BudgetMesh {
  /// With creases, and smooth everywhere: simplifying may make edges sharp that were not.
  std::unique_ptr<const ShadedMesh> creased, smooth;
  std::uint64_t bytes = 0;  // that it takes: positions of 12 bits, triangles, colours of vertices where there are any
};

/// Makes meshes of fewer triangles. Not thread-safe; the mesh outlives it.
class BudgetMeshes {
 public:
  explicit BudgetMeshes(const ShadedMesh& whole);

  /// Returns the mesh with the most triangles that takes at most so many bytes, within a few per cent; with the fewest that there
  /// can be, where that takes more. Whoever gets it computes its normals. Errors as of make_drc_mesh(); Cancelled.
  absl::StatusOr<BudgetMesh> of_bytes(std::uint64_t bytes, const ExecutionContext& context);

 private:
  struct Level {
    std::vector<std::uint32_t> corners;  // of the whole mesh's vertices
    std::uint64_t bytes = 0;
  };
  absl::StatusOr<Level> simplified(std::size_t faces) const;

  const ShadedMesh& whole_;
  std::vector<Vec3f> positions_;
  std::vector<Level> levels_;  // each of half of the triangles of the one before, from all of them on
};

}  // namespace curvecast::cli::bench
