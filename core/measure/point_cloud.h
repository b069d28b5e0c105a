// Points of any origin, made ready to be searched among.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/measure/neighbours.h"

namespace curvecast {

struct PointCloud {
  /// Absolute coordinates, all finite. `frame`: the box of their surface, which becomes as large as 1, so that floats will do for
  /// a surface of any size, anywhere. It is not empty.
  PointCloud(std::span<const Vec3d> points, const Box3d& frame);

  std::size_t size() const { return positions.size(); }
  /// As the tree's points are.
  Vec3f local(const Vec3d& p) const { return ((p - origin) / unit).cast<float>(); }
  /// In the points' own units.
  double distance(const Neighbour& n) const { return unit * std::sqrt(double{n.square}); }

  Vec3d origin;
  double unit;
  std::vector<Vec3f> positions;  // local
  NeighbourTree tree;            // of them
};

}  // namespace curvecast
