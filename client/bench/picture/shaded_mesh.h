// A mesh as it looks: what pictures of its points, and of meshes with fewer triangles, are held against.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/curve/surface_map.h"
#include "core/pipeline/pipeline.h"
#include "core/render/render_camera.h"
#include "core/render/splat_renderer.h"

namespace curvecast::cli::bench {

/// Smooth but for creases (see crease_normals()), in its own colours where it has any. Not to be moved: it refers to itself.
class ShadedMesh {
 public:
  /// Precondition: the mesh has been repaired. Without an angle its creases are those that its file means.
  explicit ShadedMesh(LoadedMesh loaded, std::optional<double> crease_degrees = std::nullopt);
  ShadedMesh(const ShadedMesh&) = delete;
  ShadedMesh& operator=(const ShadedMesh&) = delete;

  const TriangleMesh& mesh() const { return loaded_.mesh; }
  const MeshAttributes& attributes() const { return loaded_.attributes; }
  double crease_degrees() const { return crease_degrees_; }
  bool has_colours() const { return colour_ != nullptr; }
  /// Errors as of render_mesh().
  absl::StatusOr<Image> draw(const RenderCamera& camera, const RenderOptions& options,
                             const ExecutionContext& context = {}) const;

 private:
  const LoadedMesh loaded_;
  const std::vector<VertexGeometry> geometry_;
  const double crease_degrees_;
  const CreaseNormals creases_;
  const std::unique_ptr<const SurfaceColour> colour_;  // null: none
  const SurfaceData data_;
};

}  // namespace curvecast::cli::bench
