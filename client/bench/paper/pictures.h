// One picture each of what figures show of a mesh.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>

#include "client/bench/paper/hosted_mesh.h"
#include "client/cli/report.h"
#include "core/base/image.h"

namespace curvecast::cli::bench {

/// Square pictures in space, all of the whole mesh. Errors as of HostedMesh and of the renderers. The mesh outlives it.
class Pictures {
 public:
  /// `info`: of the mesh. `side`: of the pictures, pixels.
  Pictures(const HostedMesh& mesh, const v1::MeshInfo& info, int side)
      : mesh_(mesh), box_(box_of(info)), is_closed_(info.boundary_loops() == 0), side_(side) {}

  /// The camera that sees all of it, in three quarters, or along a direction from the mesh's middle: as far as `diagonals`.
  absl::StatusOr<v1::Camera> camera() const;
  v1::Camera camera_along(const Vec3d& direction, double diagonals) const;

  /// Dots where a sample lies, on an even surface, seen from `eye`. `view`: the camera of its density, or null.
  absl::StatusOr<Image> dots(const SampleFlags& sample, const v1::Camera& eye, const v1::Camera* view = nullptr) const;
  /// Progressive points as a closed surface.
  absl::StatusOr<Image> splats(std::uint64_t points) const;
  /// The curve on the surface, and in the square; the parameter mesh.
  absl::StatusOr<Image> surface_curve(std::uint64_t points) const;
  absl::StatusOr<Image> curve(std::uint64_t points, const std::string& base_density = {}) const;
  absl::StatusOr<Image> parameter_mesh() const;

 private:
  absl::StatusOr<client::Points> even_cloud() const;

  const HostedMesh& mesh_;
  Box3d box_;
  bool is_closed_;
  int side_;
};

}  // namespace curvecast::cli::bench
