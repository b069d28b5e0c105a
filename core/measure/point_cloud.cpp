#include "core/measure/point_cloud.h"

namespace curvecast {

PointCloud::PointCloud(std::span<const Vec3d> points, const Box3d& frame)
    : origin(frame.center()), unit(frame.diagonal() > 0 ? frame.diagonal() : 1), tree(all_local(points)) {}

std::vector<Vec3f> PointCloud::all_local(std::span<const Vec3d> points) const {
  std::vector<Vec3f> positions;
  positions.reserve(points.size());
  for (const Vec3d& p : points) positions.push_back(local(p));
  return positions;
}

}  // namespace curvecast
