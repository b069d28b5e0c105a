// The candidates of a stratum group: the positions among which each of its new points chooses, and how near other points come to
// them. Choosing the best of some candidates is Mitchell's way ("Spectrally optimal sampling for distribution ray tracing",
// 1991); here they do not lie at random but at equal steps along the curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progressive/curve_strata.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

inline constexpr std::size_t kCandidates = 32;  // in each child stratum
inline constexpr float kFar = std::numeric_limits<float>::max();
/// Two positions face each other when the cosine of their normals is at least this (120 degrees). Others are on the two sides of
/// something thin: the distance between them does not count.
inline constexpr float kSameSide = -0.5f;

/// Returns the distance between neighbours in a hexagonal lattice of n points on an area: the largest that n points can keep.
float lattice_distance(double area, double n);

/// The candidates of one child stratum, in columns.
struct CandidatePoints {
  float x[kCandidates], y[kCandidates], z[kCandidates];     // relative to the curve's origin
  float nx[kCandidates], ny[kCandidates], nz[kCandidates];  // unit normals
  float from_centre[kCandidates];                           // squared distance from ChildStratum::centre
  float nearest_lower[kCandidates];   // squared distance to the nearest point that comes before the next one
  float nearest_higher[kCandidates];  // least of (squared distance x rank + 1) over the points that come after the next one
};

/// What is known of a child stratum: a stratum of the level after the group's.
struct ChildStratum {
  Vec3f centre, normal;    // means over its candidates
  float radius;            // no candidate is farther from the centre
  float all_face;          // all candidates face a point whose normal has at least this cosine with `normal`
  float none_face;         // no candidate faces a point whose normal has less than this cosine
  bool has_point = false;  // already
};

struct BestCandidate {
  float value = -1;
  std::size_t index = 0;
};

/// Returns the candidate with the largest min(nearest_lower n, nearest_higher), and that value.
BestCandidate best_candidate(const float* nearest_lower, const float* nearest_higher, float n);
/// Returns, of the candidates whose value (as above) is at least `enough`, the one nearest to the centre. Any where there
/// is none.
std::size_t central_candidate(const CandidatePoints& candidates, const float* nearest_higher, float n, float enough);

/// Returns the largest of kCandidates values.
float largest_of(const float* values);

/// Places candidates at equal steps along the curve, as many in each of some child strata of a group (ascending numbers of
/// theirs); the seed moves those of each child by a part of a step. Writes their curve positions and where these lie, neither of
/// which depends on the other children. In groups of free levels they lie there about only: see PointPlaces::kAbout.
/// Precondition: as many of both, a power of two in each child.
void place_candidates(const CurveStrata& strata, const StratumGroup& group, std::uint64_t seed,
                      std::span<const std::uint32_t> children, std::span<std::uint64_t> curve_positions,
                      std::span<CurvePoint> points);
/// Returns the grain with which points of a group of a level are placed: see CurveStrata::points_at(). In free groups it is a
/// stratum, else a child stratum.
double grain_of_candidates(int level);

/// The candidates of all child strata of a group.
class GroupCandidates {
 public:
  /// Spreads the candidates; the seed moves those of each child by a part of a step.
  GroupCandidates(const CurveStrata& strata, const StratumGroup& group, std::uint64_t seed);

  std::size_t size() const { return children_.size(); }  // number of children
  const StratumGroup& group() const { return group_; }
  double total_area() const { return area_; }  // of the whole curve
  ChildStratum& child(std::size_t c) { return children_[c]; }
  const ChildStratum& child(std::size_t c) const { return children_[c]; }
  CandidatePoints& in_child(std::size_t c) { return candidates_[c]; }
  const CandidatePoints& in_child(std::size_t c) const { return candidates_[c]; }
  /// Returns a box around all candidates.
  Eigen::AlignedBox3f box() const;
  /// Makes a point at candidate k of child c.
  RankedPoint point(std::size_t c, std::size_t k, std::uint64_t rank) const;
  /// Sets is_near[c] (size() entries) to 1 where child c may have a candidate within `reach` of a position, else to 0.
  void mark_near(const float* position, float reach, std::int32_t* is_near) const;
  /// Lowers least[k] to the squared distance between p and candidate k of child c, times `weight`, where they face each other.
  void take_nearer(std::size_t c, const RankedPoint& p, float weight, float* least) const;

 private:
  void measure(std::size_t c);

  StratumGroup group_;
  double area_;
  std::vector<CurvePoint> at_;                 // kCandidates for each child
  std::vector<std::uint64_t> curve_position_;  // of each
  std::vector<CandidatePoints> candidates_;    // of each child
  std::vector<ChildStratum> children_;
  std::vector<float> x_, y_, z_, radius_;  // centres and radii of the children once more, in columns
};

}  // namespace curvecast
