// Surfaces whose principal directions are known, and what they are.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/shapes.h"

namespace curvecast::testing {

/// The direction of the larger signed curvature at a place on the surface, in either sense; none near umbilics.
using AnalyticDirection = std::function<std::optional<Vec3d>(const Vec3d&)>;

/// Angle between two axes, in radians.
inline double axis_angle(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))); }

/// Of open_cylinder().
inline std::optional<Vec3d> around_the_axis(const Vec3d& p) { return Vec3d(-p.y(), p.x(), 0); }

/// Of torus(): everywhere the tube's curvature is larger than the ring's.
inline std::optional<Vec3d> around_the_tube(const Vec3d& p) {
  const Vec3d ring = Vec3d(p.x(), p.y(), 0).normalized();
  return Vec3d(-p.y(), p.x(), 0).cross(p - ring);
}

/// x^2 / 4 + y^2 + z^2 = 1: a surface of revolution around x, bent more around the axis than along it.
inline PolygonSoup ellipsoid(int level) {
  PolygonSoup soup = icosphere(level);
  for (Vec3d& p : soup.positions) p.x() *= 2;
  return soup;
}
inline std::optional<Vec3d> on_the_ellipsoid(const Vec3d& p) {
  if (std::abs(p.x()) > 1.5) return std::nullopt;
  return Vec3d(0, -p.z(), p.y());
}

/// z = (y^2 - x^2) / 2 over |x|, |y| <= 1/2, seen from above: with normals upwards it is convex along x.
inline PolygonSoup saddle(int n) {
  std::vector<Vec3d> positions;
  std::vector<std::vector<std::uint32_t>> quads;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = static_cast<double>(i) / n - 0.5, y = static_cast<double>(j) / n - 0.5;
      positions.emplace_back(x, y, 0.5 * (y * y - x * x));
      const auto v = static_cast<std::uint32_t>(j * (n + 1) + i);
      const auto row = static_cast<std::uint32_t>(n + 1);
      if (i < n && j < n) quads.push_back({v, v + 1, v + row + 1, v + row});
    }
  }
  return soup_of(std::move(positions), quads);
}
/// From the shape operator of the graph: of z_x = -x, z_y = y, z_xx = -1, z_yy = 1, z_xy = 0.
inline std::optional<Vec3d> on_the_saddle(const Vec3d& p) {
  const double fx = -p.x(), fy = p.y();
  Eigen::Matrix2d first, second;
  first << 1 + fx * fx, fx * fy, fx * fy, 1 + fy * fy;
  second << 1, 0, 0, -1;  // positive where convex
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(second, first);
  const Eigen::Vector2d d = solver.eigenvectors().col(1);
  return Vec3d(d.x(), d.y(), fx * d.x() + fy * d.y());
}

struct KnownSurface {
  PolygonSoup soup;
  AnalyticDirection direction;
  double tolerance;  // radians, for meshes as coarse as this one
};

inline std::vector<KnownSurface> known_surfaces() {
  return {{open_cylinder(20, 60), around_the_axis, 0.05},
          {torus(80, 40), around_the_tube, 0.1},
          {ellipsoid(4), on_the_ellipsoid, 0.15},
          {saddle(40), on_the_saddle, 0.05}};
}

}  // namespace curvecast::testing
