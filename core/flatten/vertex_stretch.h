// The stretch of the triangles around one vertex as a function of the vertex's place in the parameter plane.
// Source: the L2 stretch of Sander, Snyder, Gortler, Hoppe, "Texture mapping progressive meshes" (2001), minimised vertex by
// vertex as in Sander, Gortler, Snyder, Hoppe, "Signal-specialized parametrization" (2002), with Newton's steps. A little of the
// inverse map's is added, as in Smith, Schaefer, "Bijective parameterization with free boundaries" (2015), since stretch alone
// spreads slits of the surface over wide wedges of the plane.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

/// A vertex's neighbours, counter-clockwise, and the triangles between it and each two that follow each other. Meant to be filled
/// again and again, for one vertex after the other. Not thread-safe.
class VertexStretch {
 public:
  /// `surface` is the area of all that is mapped to the unit square.
  explicit VertexStretch(double surface) : spread_(kSpread * surface * surface / 16) {}

  /// The vertex at `position` on the surface. `closed`: the last neighbour and the first make a triangle too.
  void reset(const Vec3d& position, bool closed);
  void add_neighbour(const Vec3d& position, const Vec2d& uv);
  /// To be called after the last neighbour.
  void finish();

  /// Returns the sum over the triangles of surface area times squared L2 stretch, in units of the surface's area over the
  /// plane's, and kSpread times the same of the inverse map. Infinite where a triangle is flipped or too thin for its sign to be
  /// certain.
  double energy(const Vec2d& uv) const;
  /// Tells whether all triangles turn counter-clockwise beyond doubt.
  bool valid(const Vec2d& uv) const { return !(energy(uv) == kInvalid); }

  struct Improvement {
    double energy = 0;  // before
    double fall = 0;    // of it; 0: nothing has moved
    Improvement operator+(const Improvement& other) const { return {energy + other.energy, fall + other.fall}; }
  };
  /// One over-relaxed Newton step from the valid place `uv`, shortened until it lowers the energy; along `direction` only where
  /// that is given (the side that a border vertex slides on; a unit vector).
  Improvement improve(Vec2d& uv, const std::optional<Vec2d>& direction) const;

  /// Returns a place for a vertex that has none yet: its mean value combination of the neighbours if that is valid, else the
  /// middle of the region where it is. For a border vertex, on the segment between its last and its first neighbour. nullopt:
  /// there is no such place, or it is too narrow for doubles.
  std::optional<Vec2d> place() const;

 private:
  struct Neighbour {
    Vec3d edge;  // from the vertex, on the surface
    Vec2d uv;
  };
  struct Corner {  // the triangle of the vertex with neighbours p and q
    Vec2d p, q;
    double at_vertex, at_p, at_q;  // dot products of the surface triangle's sides at its corners
    double half_area;
    double spread;  // spread_ over half_area
  };
  static constexpr double kSpread = 0.1;  // what the inverse map's stretch counts
  static constexpr double kInvalid = std::numeric_limits<double>::infinity();

  std::optional<Vec2d> place_inside() const;
  std::optional<Vec2d> place_on_border() const;

  double spread_;
  Vec3d position_ = Vec3d::Zero();
  bool closed_ = true;
  std::vector<Neighbour> neighbours_;
  std::vector<Corner> corners_;
};

}  // namespace curvecast
