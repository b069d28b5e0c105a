// The strata of a curve. The curve position of a place on the curve is the surface's area before it over the whole area, in
// [0, 1). The strata of level l are the 4^l equal intervals of curve positions. All strata of a level have the same area and,
// like the quads of a Hilbert curve, are compact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// Converts a curve position in steps of 2^-64 to a double, rounded down.
constexpr double unit_curve_position(std::uint64_t fixed) { return static_cast<double>(fixed >> 11) * 0x1p-53; }

/// Where a curve position lies in space.
struct CurvePoint {
  float position[3];     // relative to the curve's origin
  std::uint32_t vertex;  // the curve vertex in whose leaf it lies
};

/// Finds vertices and points of a curve by curve position. Keeps the curve's address. Immutable: any number of threads may ask.
class CurveStrata {
 public:
  /// Preconditions: the curve has an area; no area element is negative or not finite.
  explicit CurveStrata(const SurfaceCurve& curve);

  const SurfaceCurve& curve() const { return *curve_; }
  double total_area() const { return before_.back(); }  // sum of the area elements
  /// Returns the curve vertex on whose area element the curve position t, in [0, 1], lies.
  std::uint32_t vertex_at(double t) const;
  /// Writes the points at the curve positions t (ascending) to `points`, as many as t. A single one on a curve vertex lies at the
  /// vertex. Several are spread over the vertex' leaf, which is taken to be flat, in the order of the curve.
  void points_at(std::span<const double> t, std::span<CurvePoint> points) const;
  /// Returns about the box around all leaves that a stratum touches.
  Eigen::AlignedBox3f box(int level, std::uint64_t stratum) const;

 private:
  const SurfaceCurve* curve_;
  std::vector<double> before_;  // L + 1: area before each vertex, and the whole area
};

}  // namespace curvecast
