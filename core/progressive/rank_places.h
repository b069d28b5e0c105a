// The places that a block's points may have: some in each stratum of the next level, and how near other points come to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progressive/curve_strata.h"
#include "core/progressive/rank_block.h"

namespace curvecast {

inline constexpr std::size_t kPlaces = 32;  // that are tried for each point
inline constexpr float kFar = std::numeric_limits<float>::max();
inline constexpr float kSameSide = -0.5f;  // normals that differ by more than 120 degrees are on the two sides of something thin

/// The distance of neighbours in a hexagonal lattice of n points.
float lattice_distance(double area, double n);

/// Places in a child stratum.
struct Places {
  float x[kPlaces], y[kPlaces], z[kPlaces];
  float nx[kPlaces], ny[kPlaces], nz[kPlaces];
  float away[kPlaces];    // square distance from the center
  float before[kPlaces];  // square distance of the nearest point of a lower rank
  float after[kPlaces];   // of points of higher ranks: the least square distance times the number of points then
};

/// A stratum of the next level.
struct Child {
  Vec3f center, normal;
  float radius;               // of the places about the center
  float all_face, none_face;  // of the normal's cosine with another: from here on all places face it, below here none
  bool full = false;
};

struct BestPlace {
  float value = -1;
  std::size_t place = 0;
};

/// The place with the largest of min(before n, after).
BestPlace best_place(const float* before, const float* after, float n);
/// Of the places where that is large enough, the one nearest to the center. Precondition: there is one.
std::size_t central_place(const Places& places, const float* after, float n, float enough);

/// Of the values of a child's places.
float largest_of(const float* values);

/// Of a whole block.
class RankPlaces {
 public:
  /// `block`'s children are the strata of the next level in it.
  RankPlaces(const CurveStrata& strata, const RankBlock& block, std::uint64_t seed);

  std::size_t size() const { return children_.size(); }
  const RankBlock& block() const { return block_; }
  double total_area() const { return area_; }
  Child& child(std::size_t c) { return children_[c]; }
  const Child& child(std::size_t c) const { return children_[c]; }
  Places& places(std::size_t c) { return places_[c]; }
  const Places& places(std::size_t c) const { return places_[c]; }
  /// Around all of them.
  Eigen::AlignedBox3f box() const;
  /// A point at a place.
  RankedPoint point(std::size_t c, std::size_t place, std::uint32_t rank) const;
  /// Sets `is_near`, size() entries, to whether a child may have places as near to a point as `reach`, else to 0.
  void mark_near(const float* position, float reach, std::int32_t* is_near) const;
  /// A point's square distance from each place of child c that faces it, times `weight`, goes into `least` where it is less.
  void take_nearer(std::size_t c, const RankedPoint& p, float weight, float* least) const;

 private:
  void find(const CurveStrata& strata, std::uint64_t seed);
  void measure(std::size_t c);

  RankBlock block_;
  double area_;
  const SurfaceCurve& curve_;
  std::vector<CurvePlace> at_;             // kPlaces in each child
  std::vector<std::uint64_t> coordinate_;  // of each
  std::vector<Places> places_;             // of each child
  std::vector<Child> children_;
  std::vector<float> x_, y_, z_, radius_;  // of the children, once more: in columns
};

}  // namespace curvecast
