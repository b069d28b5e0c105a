// Points of any origin, made ready to be searched among.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/measure/neighbours.h"

namespace curvecast {

struct PointCloud {
  /// Takes absolute coordinates, all finite. `frame`, not empty, is the box of their surface: it becomes as large as 1, so that
  /// floats will do for a surface of any size, anywhere.
  PointCloud(std::span<const Vec3d> points, const Box3d& frame);

  std::size_t size() const { return tree.points().size(); }
  /// Returns the coordinates that the tree has for a point.
  Vec3f local(const Vec3d& p) const { return ((p - origin) / unit).cast<float>(); }
  /// Returns the distance of a neighbour in the points' own units.
  double distance(const Neighbour& n) const { return unit * std::sqrt(double{n.square}); }

  Vec3d origin;
  double unit;
  NeighbourTree tree;  // of the points' local coordinates

 private:
  std::vector<Vec3f> all_local(std::span<const Vec3d> points) const;
};

}  // namespace curvecast
