// The node hierarchy of a glTF scene, flattened.
#pragma once

#include <absl/status/statusor.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/mesh_io/gltf/gltf_model.h"

namespace curvecast {

struct GltfInstance {
  std::int64_t mesh = -1;
  Eigen::Affine3d world;
};

/// Finds the nodes that are children of none. InvalidArgument when there are nodes but no such.
absl::StatusOr<std::vector<std::int64_t>> gltf_roots(const std::vector<GltfNode>& nodes);

/// Finds the meshes under the `roots`, parents and earlier children first. InvalidArgument when a node is reached twice (so the
/// nodes are no trees), is not there, or has a transform of the wrong number of values.
absl::StatusOr<std::vector<GltfInstance>> gltf_instances(const std::vector<GltfNode>& nodes,
                                                         const std::vector<std::int64_t>& roots);

}  // namespace curvecast
