// The energy of points on a surface, which says where the next point makes the whole more even. Stolarsky ("Sums of distances
// between points on a sphere II", 1973): the squared discrepancy of points over balls and half spaces of all sizes is a constant
// less the sum of the distances between them. So it falls most where the next point's distances to the others are largest.
// The kernel here behaves like the distance at short range and ends smoothly at a finite one: what is farther apart is even
// anyway.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

/// The energy that points put on some fixed positions, beside the energy that an even distribution would put there.
class PointEnergy {
 public:
  /// Points farther than `range` from a position put no energy on it. Precondition: range > 0.
  PointEnergy(std::span<const Vec3f> positions, float range);

  std::size_t size() const { return x_.size(); }
  /// Counts a point among those that there will be in the end, or a position that stands for such a point.
  void expect(const float* position) { add_to(in_the_end_, position); }
  /// Counts a point among those that are there now.
  void add(const float* position) { add_to(now_, position); }
  /// Returns by how much the energy on position i exceeds what it should be when `part` of the points in the end are there: 0
  /// where the points are as dense as that, more where they are denser.
  float excess(std::size_t i, float part) const { return now_[i] - part * in_the_end_[i]; }

 private:
  void add_to(std::vector<float>& energy, const float* position) const;

  std::vector<float> x_, y_, z_;
  float inverse_range_;
  std::vector<float> now_, in_the_end_;
};

}  // namespace curvecast
