// The vector types of the whole core: concrete Eigen types, never expression templates, cross its interfaces.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>

namespace curvecast {

using Vec2d = Eigen::Vector2d;
using Vec2f = Eigen::Vector2f;
using Vec3d = Eigen::Vector3d;
using Vec3f = Eigen::Vector3f;

/// Three vertex indices, counter-clockwise seen from outside.
using Triangle = std::array<std::uint32_t, 3>;

/// Axis-aligned box; empty when min > max.
struct Box3d {
  Vec3d min = Vec3d::Constant(std::numeric_limits<double>::infinity());
  Vec3d max = Vec3d::Constant(-std::numeric_limits<double>::infinity());

  void extend(const Vec3d& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  double diagonal() const { return (max - min).norm(); }
  Vec3d center() const { return 0.5 * (min + max); }
};

}  // namespace curvecast
