// How crowded places on a surface are, so that the next point goes where it makes the whole more even. The square discrepancy of
// points over balls and half spaces of all sizes is a sum of distances between them (Stolarsky, "Sums of distances between points
// on a sphere II", 1973), which the next point lowers most where its distances to the others are largest; what is far enough to
// be even already is left out, smoothly.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

/// Of some places, among points of which more and more are there.
class Crowding {
 public:
  /// Points farther than `range` from a place are not felt there. Precondition: range > 0.
  Crowding(std::span<const Vec3f> places, float range);

  std::size_t size() const { return x_.size(); }
  /// A point that is going to be there, or stands for one.
  void expect(const float* position) { add_to(in_the_end_, position); }
  /// A point is there now.
  void add(const float* position) { add_to(now_, position); }
  /// Of place i, when that part of all points should be there: 0 where they are as dense as that, more where they are denser.
  float at(std::size_t i, float part) const { return now_[i] - part * in_the_end_[i]; }

 private:
  void add_to(std::vector<float>& felt, const float* position) const;

  std::vector<float> x_, y_, z_;
  float inverse_range_;
  std::vector<float> now_, in_the_end_;
};

}  // namespace curvecast
