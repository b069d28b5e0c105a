// The Voronoi cells of points on a surface, each in the plane of its point.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "core/base/vec.h"
#include "core/sample/point_blocks.h"

namespace curvecast {

/// Spacings: how far a cell goes from its point where there are no others.
inline constexpr float kCellRadius = 0.85F;
/// What list_near() has to be called with, for the block's own box, before voronoi_cell().
inline constexpr float kCellReach = 2 * kCellRadius, kCellLeast = std::numeric_limits<float>::max();

/// A convex region around the origin in a plane through it, known by how far it goes in a few directions. So lines take what is
/// beyond them without a branch, and as many as there are; the region's corners are cut off.
class VoronoiCell {
 public:
  static constexpr std::size_t kDirections = 16;

  /// A circle. `normal`: of the plane; unit length, or zero: then there is no plane, and centre() is zero.
  VoronoiCell(const Vec3f& normal, float radius);

  /// From the origin, unit length; k < kDirections.
  Vec3f direction(std::size_t k) const;

  /// Takes off what is farther in the direction of a place than `part` of the way there, as if it were in the plane.
  void cut(const Vec3f& to, float part);

  /// Of the polygon through the ends of the directions.
  float area() const;
  /// From the origin to that polygon's centre of gravity.
  Vec3f centre() const;

 private:
  friend VoronoiCell voronoi_cell(const PointBlocks& points, std::size_t i, PointBlocks::Scratch& scratch);

  Vec3f x_axis_ = Vec3f::Zero(), y_axis_ = Vec3f::Zero();
  float radius_;
  std::array<float, kDirections> inverse_;  // of how far it goes, in radii
};

/// Returns the cell of the point, around its position, among those nearer than kCellReach spacings of its own that do not face
/// away from it; of what is between two points each has a share as large as its spacing. `scratch`: as list_near() has left it
/// for the point's block. For any number of threads at a time, each with its scratch.
VoronoiCell voronoi_cell(const PointBlocks& points, std::size_t i, PointBlocks::Scratch& scratch);

}  // namespace curvecast
