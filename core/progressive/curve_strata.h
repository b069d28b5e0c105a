// The strata of a curve. The curve position of a place on the curve is the surface's area before it over the whole area, in
// [0, 1). The strata of level l are the 4^l equal intervals of curve positions. All strata of a level have the same area and,
// like the quads of a Hilbert curve, are compact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/curve/leaf_surface.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// Converts a curve position in steps of 2^-64 to a double, rounded down.
constexpr double unit_curve_position(std::uint64_t fixed) { return static_cast<double>(fixed >> 11) * 0x1p-53; }

/// Where a curve position lies in space, relative to the curve's origin.
struct CurvePoint : SurfacePlace {
  std::uint32_t vertex;  // the curve vertex in whose leaf it lies
};

/// How exactly points are placed that lie in leaves no larger than a grain.
enum class PointPlaces : std::uint8_t {
  kAtVertices,  // in leaves of at most a twentieth of the grain at the vertex, in others on the surface
  kOnSurface,   // so that no two lie at one place
  kAbout,       // in the plane of the leaf, with the vertex's normal, where the leaves around tell it; there the face is kNone
};

/// Finds vertices and points of a curve by curve position. Keeps the surface's address. Immutable: any number of threads may ask.
class CurveStrata {
 public:
  /// Preconditions: the curve has an area; no area element is negative or not finite.
  explicit CurveStrata(const LeafSurface& surface);

  /// From now on, the same surface, with the same curve, is taken from there.
  void move_to(const LeafSurface& surface) { surface_ = &surface; }

  const LeafSurface& surface() const { return *surface_; }
  const SurfaceCurve& curve() const { return surface_->curve(); }
  double total_area() const { return before_.back(); }  // sum of the area elements
  /// Returns the curve vertex on whose area element the curve position t, in [0, 1], lies.
  std::uint32_t vertex_at(double t) const;
  /// Writes the points at the curve positions t (ascending) to `points`, as many as t. They lie where the curve passes within the
  /// leaf, on the surface: see LeafSurface::find(), where `grain` is a share of the leaf's area and here of the whole.
  void points_at(std::span<const double> t, double grain, std::span<CurvePoint> points,
                 PointPlaces places = PointPlaces::kAtVertices) const;
  /// Returns `count` points spread evenly over a stratum; the grain is the share of one of them, or with kAbout that of four.
  std::vector<CurvePoint> spread_over(int level, std::uint64_t stratum, std::size_t count,
                                      PointPlaces places = PointPlaces::kAtVertices) const;
  /// Says whether a stratum lies in so few leaves that their vertices say little of it.
  bool is_within_leaves(int level, std::uint64_t stratum) const;

 private:
  CurvePoint at_vertex(std::uint32_t l) const;
  CurvePoint about_vertex(std::uint32_t l, const Vec3f& offset) const;

  const LeafSurface* surface_;
  std::vector<double> before_;  // L + 1: area before each vertex, and the whole area
};

}  // namespace curvecast
