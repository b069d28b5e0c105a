// The positions among which a block's points choose theirs: some in each stratum of the next level, and how near other points
// come to them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progressive/curve_strata.h"
#include "core/progressive/rank_block.h"

namespace curvecast {

inline constexpr std::size_t kCandidates = 32;  // in each child
inline constexpr float kFar = std::numeric_limits<float>::max();
inline constexpr float kSameSide = -0.5f;  // normals that differ by more than 120 degrees are on the two sides of something thin

/// The distance of neighbours in a hexagonal lattice of n points.
float lattice_distance(double area, double n);

/// The candidates of a child, in columns.
struct CandidatePoints {
  float x[kCandidates], y[kCandidates], z[kCandidates];
  float nx[kCandidates], ny[kCandidates], nz[kCandidates];
  float away[kCandidates];    // square distance from the center
  float before[kCandidates];  // square distance of the nearest point of a lower rank
  float after[kCandidates];   // of points of higher ranks: the least square distance times the number of points then
};

/// A stratum of the next level.
struct Child {
  Vec3f center, normal;
  float radius;               // of the candidates about the center
  float all_face, none_face;  // of the normal's cosine with another: from here on all candidates face it, below here none
  bool full = false;
};

struct BestCandidate {
  float value = -1;
  std::size_t index = 0;
};

/// The candidate with the largest min(before n, after).
BestCandidate best_candidate(const float* before, const float* after, float n);
/// Of the candidates for which that is large enough, the one nearest to the center. Precondition: there is one.
std::size_t central_candidate(const CandidatePoints& candidates, const float* after, float n, float enough);

/// The largest of kCandidates values.
float largest_of(const float* values);

/// The candidates of a whole block.
class GroupCandidates {
 public:
  /// `block`'s children are the strata of the next level in it.
  GroupCandidates(const CurveStrata& strata, const RankBlock& block, std::uint64_t seed);

  std::size_t size() const { return children_.size(); }
  const RankBlock& block() const { return block_; }
  double total_area() const { return area_; }
  Child& child(std::size_t c) { return children_[c]; }
  const Child& child(std::size_t c) const { return children_[c]; }
  CandidatePoints& in_child(std::size_t c) { return candidates_[c]; }
  const CandidatePoints& in_child(std::size_t c) const { return candidates_[c]; }
  /// Around all of them.
  Eigen::AlignedBox3f box() const;
  /// A point at candidate k of child c.
  RankedPoint point(std::size_t c, std::size_t k, std::uint32_t rank) const;
  /// Sets `is_near`, size() entries, to whether a child may have candidates as near to a point as `reach`, else to 0.
  void mark_near(const float* position, float reach, std::int32_t* is_near) const;
  /// A point's square distance from each candidate of child c that faces it, times `weight`, goes into `least` where it is less.
  void take_nearer(std::size_t c, const RankedPoint& p, float weight, float* least) const;

 private:
  void find(const CurveStrata& strata, std::uint64_t seed);
  void measure(std::size_t c);

  RankBlock block_;
  double area_;
  const SurfaceCurve& curve_;
  std::vector<CurvePlace> at_;               // kCandidates in each child
  std::vector<std::uint64_t> coordinate_;    // of each
  std::vector<CandidatePoints> candidates_;  // of each child
  std::vector<Child> children_;
  std::vector<float> x_, y_, z_, radius_;  // of the children, once more: in columns
};

}  // namespace curvecast
