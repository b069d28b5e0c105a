#include "core/mesh_io/gltf/gltf_nodes.h"

#include <absl/strings/str_format.h>

#include "core/base/vec.h"
#include "core/mesh_io/gltf/gltf_accessor.h"

namespace curvecast {
namespace {

bool is_there(const std::vector<GltfNode>& nodes, std::int64_t index) {
  return index >= 0 && index < static_cast<std::int64_t>(nodes.size());
}

absl::StatusOr<Eigen::Affine3d> transform_of(const GltfNode& node, std::int64_t number) {
  if (node.transform == nullptr) return Eigen::Affine3d::Identity();
  const auto& [matrix, translation, rotation, scale] = *node.transform;
  const auto fits = [](const std::vector<double>& values, std::size_t size) { return values.empty() || values.size() == size; };
  if (!fits(matrix, 16) || !fits(translation, 3) || !fits(rotation, 4) || !fits(scale, 3)) {
    return absl::InvalidArgumentError(absl::StrFormat("node %d has a transform of the wrong number of values", number));
  }
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  if (!matrix.empty()) {
    transform.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix4d>(matrix.data()).topRows<3>();
    return transform;
  }
  if (!translation.empty()) transform.translate(Vec3d(translation[0], translation[1], translation[2]));
  if (!rotation.empty()) {
    const Eigen::Quaterniond q(rotation[3], rotation[0], rotation[1], rotation[2]);
    if (q.squaredNorm() > 0) transform.rotate(q.normalized());
  }
  if (!scale.empty()) transform.scale(Vec3d(scale[0], scale[1], scale[2]));
  return transform;
}

}  // namespace

absl::StatusOr<std::vector<std::int64_t>> gltf_roots(const std::vector<GltfNode>& nodes) {
  std::vector<bool> is_child(nodes.size(), false);
  for (const GltfNode& node : nodes) {
    for (const std::int64_t child : node.children) {
      if (is_there(nodes, child)) is_child[static_cast<std::size_t>(child)] = true;
    }
  }
  std::vector<std::int64_t> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<std::int64_t>(i));
  }
  if (!roots.empty() || nodes.empty()) return roots;
  return absl::InvalidArgumentError("every node is a child of another: nodes are their own ancestors");
}

absl::StatusOr<std::vector<GltfInstance>> gltf_instances(const std::vector<GltfNode>& nodes,
                                                         const std::vector<std::int64_t>& roots) {
  // On the way down: one entry for each level, not for each node, of which a file may have millions.
  struct Level {
    const std::vector<std::int64_t>* nodes;
    std::size_t next;
    Eigen::Affine3d parent;
  };
  std::vector<GltfInstance> instances;
  std::vector<Level> stack;
  std::vector<bool> reached(nodes.size(), false);
  const auto enter = [&](const std::vector<std::int64_t>& children, const Eigen::Affine3d& parent) {
    for (const std::int64_t child : children) {
      if (!is_there(nodes, child)) return gltf_has_no("node", child, nodes.size());
      if (reached[static_cast<std::size_t>(child)]) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "node %d is reached twice: it is its own ancestor or has two parents, but nodes have to form trees", child));
      }
      reached[static_cast<std::size_t>(child)] = true;
    }
    if (!children.empty()) stack.push_back({&children, 0, parent});
    return absl::OkStatus();
  };
  if (absl::Status status = enter(roots, Eigen::Affine3d::Identity()); !status.ok()) return status;
  while (!stack.empty()) {
    Level& level = stack.back();
    if (level.next == level.nodes->size()) {
      stack.pop_back();
      continue;
    }
    const std::int64_t number = (*level.nodes)[level.next++];
    const GltfNode& node = nodes[static_cast<std::size_t>(number)];
    const absl::StatusOr<Eigen::Affine3d> own = transform_of(node, number);
    if (!own.ok()) return own.status();
    const Eigen::Affine3d world = level.parent * *own;
    if (node.mesh >= 0) instances.push_back({node.mesh, world});
    if (absl::Status status = enter(node.children, world); !status.ok()) return status;
  }
  return instances;
}

}  // namespace curvecast
