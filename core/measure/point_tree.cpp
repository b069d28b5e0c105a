#include "core/measure/point_tree.h"

#include "core/measure/kd_order.h"

namespace curvecast {
namespace {

constexpr std::size_t kLeaf = 16;  // as NeighbourTree has them

}  // namespace

PointTree::PointTree(std::span<const Vec3d> points, const Box3d& frame)
    : origin(frame.center()), unit(frame.diagonal() > 0 ? frame.diagonal() : 1), order(kd_order(points, kLeaf)) {
  positions.reserve(points.size());
  for (const std::uint32_t i : order) positions.push_back(local(points[i]));
  tree = NeighbourTree(view_of(positions));
}

}  // namespace curvecast
