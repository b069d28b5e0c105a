// A curve without a mesh.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/random.h"
#include "core/curve/surface_curve.h"

namespace curvecast::testing {

/// A sphere of `n` curve vertices of equal area, with curvatures that have nothing to do with it: random, with flat places.
inline SurfaceCurve sphere_curve(std::size_t n = 5000, double radius = 1, const Vec3d& origin = Vec3d::Zero()) {
  SurfaceCurve curve;
  curve.resize(n);
  curve.disc_begin = {0, static_cast<std::uint32_t>(n)};
  curve.origin = origin;
  for (std::size_t l = 0; l < n; ++l) {
    const double z = 1 - (2 * static_cast<double>(l) + 1) / static_cast<double>(n);
    const double a = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(l);
    const Vec3d normal(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z);
    curve.x[l] = static_cast<float>(radius * normal.x());
    curve.y[l] = static_cast<float>(radius * normal.y());
    curve.z[l] = static_cast<float>(radius * normal.z());
    curve.nx[l] = static_cast<float>(normal.x());
    curve.ny[l] = static_cast<float>(normal.y());
    curve.nz[l] = static_cast<float>(normal.z());
    curve.area[l] = static_cast<float>(4 * std::numbers::pi * radius * radius / static_cast<double>(n));
    const double strong = l % 7 == 0 ? 0 : std::exp(4 * random_unit(3, l));
    curve.curvature_min[l] = static_cast<float>((random_unit(4, l) - 0.5) * strong / radius);
    curve.curvature_max[l] = static_cast<float>(strong / radius);
  }
  curve.total_area = 4 * std::numbers::pi * radius * radius;
  curve.box.extend(origin + Vec3d::Constant(radius));
  curve.box.extend(origin - Vec3d::Constant(radius));
  curve.max_points = n;
  curve.reference_curvature = reference_curvatures(curve);
  return curve;
}

}  // namespace curvecast::testing
