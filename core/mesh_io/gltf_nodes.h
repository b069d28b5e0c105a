// The node hierarchy of a glTF scene, flattened.
#pragma once

#include <absl/status/statusor.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace curvecast {

/// As in the file. Transforms: a matrix of 16 values by columns, or translation (3), rotation (quaternion, x y z w) and scale
/// (3); empty where there is none.
struct GltfNode {
  std::int64_t mesh = -1;
  std::vector<int> children;
  std::vector<double> matrix, translation, rotation, scale;
};

struct GltfInstance {
  std::int64_t mesh = -1;
  Eigen::Affine3d world;
};

/// The nodes that are children of none. InvalidArgument when there are nodes but no such.
absl::StatusOr<std::vector<int>> gltf_roots(const std::vector<GltfNode>& nodes);

/// The meshes under the `roots`, parents and earlier children first. InvalidArgument when a node is reached twice (so the nodes
/// are no trees), is not there, or has a transform of the wrong number of values.
absl::StatusOr<std::vector<GltfInstance>> gltf_instances(const std::vector<GltfNode>& nodes, const std::vector<int>& roots);

}  // namespace curvecast
