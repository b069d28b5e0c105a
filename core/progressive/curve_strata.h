// The area coordinate of a curve, in [0, 1), and its strata: those of level l are the 4^l equal intervals of it, each of the
// same area of the surface and, like the quads of a Hilbert curve, each compact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// Of a coordinate in steps of 2^-64, rounded down to a double.
constexpr double curve_coordinate(std::uint64_t fixed) { return static_cast<double>(fixed >> 11) * 0x1p-53; }

struct CurvePlace {
  float position[3];     // relative to the curve's origin
  std::uint32_t vertex;  // whose leaf it is in
};

/// Where the curve's vertices lie on the area coordinate. Keeps the curve's address. Immutable: any number of threads may ask.
class CurveStrata {
 public:
  /// Preconditions: the curve has an area; no area element is negative or not finite.
  explicit CurveStrata(const SurfaceCurve& curve);

  const SurfaceCurve& curve() const { return *curve_; }
  double total_area() const { return before_.back(); }  // sum of the area elements
  /// The curve vertex on whose area element the coordinate, in [0, 1], lies.
  std::uint32_t vertex_at(double t) const;
  /// The places with the given coordinates, which ascend; `places` has as many entries. A coordinate that has a curve vertex to
  /// itself is there; several on one vertex are spread over its leaf, which is taken to be flat, in the order of the curve.
  void places_at(std::span<const double> t, std::span<CurvePlace> places) const;
  /// Around all leaves that a stratum touches, more or less.
  Eigen::AlignedBox3f box(int level, std::uint64_t stratum) const;

 private:
  const SurfaceCurve* curve_;
  std::vector<double> before_;  // L + 1: area before each vertex, and all of it
};

}  // namespace curvecast
