#include "core/measure/point_cloud.h"

namespace curvecast {

PointCloud::PointCloud(std::span<const Vec3d> points, const Box3d& frame)
    : origin(frame.center()), unit(frame.diagonal() > 0 ? frame.diagonal() : 1) {
  positions.reserve(points.size());
  for (const Vec3d& p : points) positions.push_back(local(p));
  tree = NeighbourTree(view_of(positions));
}

}  // namespace curvecast
