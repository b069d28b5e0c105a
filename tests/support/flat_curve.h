// A curve whose every number is known: the Hilbert curve on the unit square in the plane z = 0.
#pragma once

#include <memory>
#include <utility>

#include "core/curve/hilbert.h"
#include "core/curve/surface_curve.h"
#include "core/pipeline/curve_surface.h"
#include "tests/support/shapes.h"

namespace curvecast::testing {

/// Of 4^level leaves, which are the surface's quads too.
inline std::shared_ptr<SurfaceCurve> flat_curve(int level) {
  auto curve = std::make_shared<SurfaceCurve>();
  const std::size_t n = std::size_t{1} << 2 * level;
  const float side = 1 / static_cast<float>(1 << level);
  curve->resize(n);
  for (std::size_t l = 0; l < n; ++l) {
    const HilbertCell cell = hilbert_cell(l, level);
    curve->x[l] = (static_cast<float>(cell.x) + 0.5f) * side;
    curve->y[l] = (static_cast<float>(cell.y) + 0.5f) * side;
    curve->z[l] = 0;
    curve->nx[l] = 0;
    curve->ny[l] = 0;
    curve->nz[l] = 1;
    curve->area[l] = side * side;
    // Of the square's two triangles: see flat_surface().
    const float x = curve->x[l], y = curve->y[l];
    curve->triangle[l] = y <= x ? 0 : 1;
    curve->weight_1[l] = y <= x ? x - y : x;
    curve->weight_2[l] = y <= x ? y : y - x;
    curve->key[l] = std::uint64_t{l} << 2 * (kMaxLevel - level);
    curve->level[l] = static_cast<std::uint8_t>(level);
  }
  curve->disc_begin = {0, static_cast<std::uint32_t>(n)};
  curve->total_area = 1;
  curve->box.extend(Vec3d(0, 0, 0));
  curve->box.extend(Vec3d(1, 1, 0));
  return curve;
}

/// The square itself, two triangles, below a curve on it.
inline std::shared_ptr<const LeafSurface> flat_surface(std::shared_ptr<const SurfaceCurve> curve) {
  auto square = std::make_shared<FlattenedMesh>();
  square->loaded.mesh = make_mesh(soup_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
  square->geometry = differential_geometry(square->loaded.mesh);
  Chart chart;
  static_cast<TriangleMesh&>(chart.disc) = square->loaded.mesh;
  chart.disc.face_of = {0, 1};
  chart.disc.border = {0, 1, 2, 3};
  for (const Vec3d& p : chart.disc.positions) chart.uv.emplace_back(p.head<2>());
  square->charts.push_back(std::move(chart));
  return std::make_shared<const LeafSurface>(*curve_base(std::move(square)), std::move(curve));
}

}  // namespace curvecast::testing
