#include "core/progressive/candidate_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/packed_distance.h"
#include "core/base/random.h"
#include "core/base/simd.h"
#include "core/progressive/group_order.h"

namespace curvecast {
namespace {

/// Lowers least[k] to the squared distance between p and candidate k, times `weight`.
CURVECAST_WIDE void take_all_nearer(const CandidatePoints& candidates, const RankedPoint& p, float weight, float* least) {
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float x = candidates.x[k] - p.position[0], y = candidates.y[k] - p.position[1], z = candidates.z[k] - p.position[2];
    const float d = (x * x + y * y + z * z) * weight;
    least[k] = d < least[k] ? d : least[k];
  }
}

/// Does the same for the candidates that face the point.
CURVECAST_WIDE void take_facing_nearer(const CandidatePoints& candidates, const RankedPoint& p, float weight, float* least) {
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float x = candidates.x[k] - p.position[0], y = candidates.y[k] - p.position[1], z = candidates.z[k] - p.position[2];
    const float cosine = candidates.nx[k] * p.normal[0] + candidates.ny[k] * p.normal[1] + candidates.nz[k] * p.normal[2];
    const float square = (x * x + y * y + z * z) * weight;
    const float d = cosine >= kSameSide ? square : kFar;
    least[k] = d < least[k] ? d : least[k];
  }
}

/// Marks which of n spheres come as near as `reach` to a point.
CURVECAST_WIDE void mark_spheres(const float* xs, const float* ys, const float* zs, const float* radii, std::size_t n,
                                 const float* p, float reach, std::int32_t* is_near) {
  const float px = p[0], py = p[1], pz = p[2];
  for (std::size_t i = 0; i < n; ++i) {
    const float x = xs[i] - px, y = ys[i] - py, z = zs[i] - pz, most = reach + radii[i];
    is_near[i] = x * x + y * y + z * z <= most * most;
  }
}

/// The first of the candidates' values that is this one; 0 where none is: of a damaged surface they may be no numbers.
std::size_t index_of(float value, const float* values) {
  const float* const end = values + kCandidates;
  const float* const found = std::find(values, end, value);
  return found == end ? 0 : static_cast<std::size_t>(found - values);
}

}  // namespace

float lattice_distance(double area, double n) { return static_cast<float>(packed_distance(area, n)); }

CURVECAST_WIDE BestCandidate best_candidate(const float* nearest_lower, const float* nearest_higher, float n) {
  float value[kCandidates];
  float most = -1;
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float b = nearest_lower[k] * n;
    value[k] = b < nearest_higher[k] ? b : nearest_higher[k];
    most = value[k] > most ? value[k] : most;
  }
  return {most, index_of(most, value)};
}

CURVECAST_WIDE std::size_t central_candidate(const CandidatePoints& candidates, const float* nearest_higher, float n,
                                             float enough) {
  float away[kCandidates];
  float least = kFar;
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float b = candidates.nearest_lower[k] * n;
    const float value = b < nearest_higher[k] ? b : nearest_higher[k];
    away[k] = value >= enough ? candidates.from_centre[k] : kFar;
    least = away[k] < least ? away[k] : least;
  }
  return index_of(least, away);
}

CURVECAST_WIDE float largest_of(const float* values) {
  constexpr std::size_t kLanes = 8;
  float most[kLanes];
  std::copy_n(values, kLanes, most);
  for (std::size_t k = kLanes; k < kCandidates; k += kLanes) {
    for (std::size_t i = 0; i < kLanes; ++i) most[i] = values[k + i] > most[i] ? values[k + i] : most[i];
  }
  return *std::max_element(most, most + kLanes);
}

void place_candidates(const CurveStrata& strata, const StratumGroup& group, std::uint64_t seed,
                      std::span<const std::uint32_t> children, std::span<std::uint64_t> curve_positions,
                      std::span<CurvePoint> points) {
  const std::size_t in_each = points.size() / children.size();
  std::vector<double> t(points.size());
  const int shift = child_shift(group.level);
  const std::uint64_t step = (std::uint64_t{1} << shift) / in_each;
  for (std::size_t c = 0; c < children.size(); ++c) {
    const std::uint64_t stratum = group.index * 4 * group.size() + children[c];
    const double offset = random_unit(seed + static_cast<std::uint64_t>(group.level), stratum);
    std::uint64_t position = (stratum << shift) + static_cast<std::uint64_t>(offset * static_cast<double>(step));
    for (std::size_t i = c * in_each; i < (c + 1) * in_each; ++i, position += step) {
      curve_positions[i] = position;
      t[i] = unit_curve_position(position);
    }
  }
  strata.points_at(t, grain_of_candidates(group.level), points,
                   GroupOrder::is_free(group.level) ? PointPlaces::kAbout : PointPlaces::kAtVertices);
}

double grain_of_candidates(int level) { return std::ldexp(1.0, -2 * (GroupOrder::is_free(level) ? level : level + 1)); }

GroupCandidates::GroupCandidates(const CurveStrata& strata, const StratumGroup& group, std::uint64_t seed)
    : group_(group),
      area_(strata.total_area()),
      at_(4 * group.size() * kCandidates),
      curve_position_(at_.size()),
      candidates_(4 * group.size()),
      children_(candidates_.size()) {
  std::vector<std::uint32_t> all(size());
  std::iota(all.begin(), all.end(), 0u);
  place_candidates(strata, group, seed, all, curve_position_, at_);
  for (std::size_t c = 0; c < size(); ++c) {
    measure(c);
    const ChildStratum& child = children_[c];
    x_.push_back(child.centre.x());
    y_.push_back(child.centre.y());
    z_.push_back(child.centre.z());
    radius_.push_back(child.radius);
  }
}

void GroupCandidates::measure(std::size_t c) {
  CandidatePoints& candidates = candidates_[c];
  ChildStratum& child = children_[c];
  const float far = lattice_distance(area_, std::ldexp(1.0, 2 * group_.level));
  Vec3f sum = Vec3f::Zero(), normals = Vec3f::Zero();
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const CurvePoint& at = at_[c * kCandidates + k];
    const Vec3f normal(at.normal[0], at.normal[1], at.normal[2]);
    candidates.x[k] = at.position[0], candidates.y[k] = at.position[1], candidates.z[k] = at.position[2];
    candidates.nx[k] = normal.x(), candidates.ny[k] = normal.y(), candidates.nz[k] = normal.z();
    candidates.nearest_lower[k] = far * far;
    candidates.nearest_higher[k] = kFar;
    sum += Vec3f(at.position[0], at.position[1], at.position[2]);
    normals += normal;
  }
  child.centre = sum / kCandidates;
  child.normal = normals.normalized();
  float square = 0, cosine = 1;
  for (std::size_t k = 0; k < kCandidates; ++k) {
    candidates.from_centre[k] = (Vec3f(candidates.x[k], candidates.y[k], candidates.z[k]) - child.centre).squaredNorm();
    square = std::max(square, candidates.from_centre[k]);
    cosine = std::min(cosine, Vec3f(candidates.nx[k], candidates.ny[k], candidates.nz[k]).dot(child.normal));
  }
  child.radius = std::sqrt(square);
  // Cosines of 120 degrees less and more half the angle of the normals' cone, with a little slack.
  constexpr float kSlack = 1e-3f;
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine)), half_turn = 0.5f * std::numbers::sqrt3_v<float>;
  child.all_face = cosine > 0.5f ? kSameSide * cosine + half_turn * sine + kSlack : 2;
  child.none_face = cosine > 0.5f ? kSameSide * cosine - half_turn * sine - kSlack : -2;
}

Eigen::AlignedBox3f GroupCandidates::box() const {
  Eigen::AlignedBox3f box;
  for (const ChildStratum& child : children_) {
    const Vec3f radius = Vec3f::Constant(child.radius);
    box.extend(child.centre - radius);
    box.extend(child.centre + radius);
  }
  return box;
}

RankedPoint GroupCandidates::point(std::size_t c, std::size_t k, std::uint64_t rank) const {
  return {at_[c * kCandidates + k], curve_position_[c * kCandidates + k], rank};
}

void GroupCandidates::mark_near(const float* position, float reach, std::int32_t* is_near) const {
  mark_spheres(x_.data(), y_.data(), z_.data(), radius_.data(), size(), position, reach, is_near);
}

void GroupCandidates::take_nearer(std::size_t c, const RankedPoint& p, float weight, float* least) const {
  const ChildStratum& child = children_[c];
  const float cosine = child.normal.dot(Vec3f(p.normal[0], p.normal[1], p.normal[2]));
  if (cosine >= child.all_face) {
    take_all_nearer(candidates_[c], p, weight, least);
  } else if (cosine >= child.none_face) {
    take_facing_nearer(candidates_[c], p, weight, least);
  }
}

}  // namespace curvecast
