// How far the shares that regions of a surface have of some samples are from their shares of its area (paper, section 4.2).
#pragma once

#include <algorithm>
#include <cmath>

namespace curvecast {

struct Discrepancy {
  double max = 0, rms = 0;  // of |share of the samples - share of the area|, as fractions of the whole
  /// `rms` over what as many random samples are expected to have in the same regions: n of them have a mean square of
  /// a (1 - a) / n in a region with the share a of the area. 0 where every region is all or nothing.
  double rms_relative = 0;
};

/// Over regions, one after the other. Sums may be added up in their turn.
struct DiscrepancySum {
  double max = 0, square = 0, random_square = 0, weight = 0;

  void add(double samples_share, double area_share) {
    const double difference = std::abs(samples_share - area_share);
    max = std::max(max, difference);
    square += difference * difference;
    random_square += area_share * (1 - area_share);
    weight += 1;
  }
  /// Adds all regions of `other`, which together count as one.
  void add_mean(const DiscrepancySum& other) {
    max = std::max(max, other.max);
    square += other.square / other.weight;
    random_square += other.random_square / other.weight;
    weight += 1;
  }
  /// Returns the discrepancy of n samples over the regions that were added.
  Discrepancy result(double n) const {
    return {max, std::sqrt(square / weight), random_square > 0 ? std::sqrt(n * square / random_square) : 0};
  }
};

}  // namespace curvecast
