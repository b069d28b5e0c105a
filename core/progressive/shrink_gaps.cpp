#include "core/progressive/shrink_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/simd.h"

namespace curvecast {
namespace {

// README.md says where these come from. "Fine" lattice distances are those of all 4 n points of the level.
constexpr float kGapRange = 1.1f;             // lattice distances: a point farther from a candidate leaves a wide gap there
constexpr float kKeptRelativeRadius = 0.58f;  // no move brings a point nearer to another
constexpr float kExpectedRange = 3;           // fine lattice distances: points to come in strata nearer than this are expected
constexpr float kOneGap = 0.5f;               // fine lattice distances: wide places nearer to each other are one gap
// The children of a group have some 50 points around on average. With more than this the surface is crumpled up there: gaps are
// left, for the work would grow with a high power of their number.
constexpr std::size_t kCrowd = 192;
// Points that are looked at for a group: on the surfaces that we have 30,000 on average, 500,000 at most. With more, gaps stay.
constexpr std::uint64_t kMostLooks = 1'000'000;

using Row = std::array<float, kCandidates>;

/// Raises gap[k] to nearest[k] n: the measure of a gap with the squared radius nearest[k] while there are n points.
CURVECAST_WIDE void widen(float* gap, const float* nearest, float n) {
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float h = nearest[k] * n;
    gap[k] = h > gap[k] ? h : gap[k];
  }
}

Vec3f position_of(const RankedPoint& p) { return {p.position[0], p.position[1], p.position[2]}; }
Vec3f position_of(const CandidatePoints& candidates, std::size_t k) {
  return {candidates.x[k], candidates.y[k], candidates.z[k]};
}

/// Calls visit(i) for every entry that is marked: few, in runs.
template <typename Visit>
void for_each_marked(std::span<const std::int32_t> marks, Visit&& visit) {
  constexpr std::size_t kRun = 8;
  for (std::size_t begin = 0; begin < marks.size(); begin += kRun) {
    const std::size_t end = std::min(begin + kRun, marks.size());
    std::int32_t any = 0;
    for (std::size_t i = begin; i < end; ++i) any |= marks[i];
    for (std::size_t i = begin; any && i < end; ++i) {
      if (marks[i]) visit(i);
    }
  }
}

/// Measures gaps by their squared radius times the number of points there are.
class GapShrinker {
 public:
  GapShrinker(const CurveStrata& strata, const GroupCandidates& candidates, std::span<const RankedPoint> done,
              std::span<const RankedPoint> open, std::span<RankedPoint> points)
      : candidates_(candidates),
        points_(points),
        n_(std::uint64_t{1} << 2 * candidates.group().level),
        fine_(lattice_distance(candidates.total_area(), static_cast<double>(4 * n_))),
        unit_(lattice_distance(candidates.total_area(), 1)),
        wide_(kWideGap * kWideGap * unit_ * unit_),
        box_(candidates.box()),
        others_(done.begin(), done.end()) {
    others_.insert(others_.end(), open.begin(), open.end());
    real_ = points_.size() + others_.size();
    expect_points(strata, open);
    find_around();
  }

  void run() {
    if (is_crowded_) return;
    std::vector<std::pair<float, std::size_t>> widest;
    for (std::size_t c = 0; c < around_.size(); ++c) {
      const float gap = widest_gap_in(c).value;
      if (gap > wide_) widest.emplace_back(-gap, c);
    }
    std::sort(widest.begin(), widest.end());
    std::vector<Vec3f> tried;
    for (const auto& [gap, c] : widest) {
      if (looks_ > kMostLooks) return;
      const BestCandidate now = widest_gap_in(c);
      const Vec3f middle = position_of(candidates_.in_child(c), now.index);
      const auto is_same = [&](const Vec3f& x) { return (x - middle).squaredNorm() < kOneGap * kOneGap * fine_ * fine_; };
      if (now.value <= wide_ || std::any_of(tried.begin(), tried.end(), is_same)) continue;
      tried.push_back(middle);
      close(c, middle, now.value);
    }
  }

 private:
  /// The i-th of: the group's points, points of other groups, points expected there.
  const RankedPoint& point(std::size_t i) const { return i < points_.size() ? points_[i] : others_[i - points_.size()]; }
  bool moves(std::size_t i) const { return i < points_.size() && points_[i].rank >= n_; }

  /// Adds the points that are to come in open groups. Their strata are known: each counts as there, in the middle of its stratum.
  void expect_points(const CurveStrata& strata, std::span<const RankedPoint> open) {
    const int shift = child_shift(candidates_.group().level);
    std::vector<std::pair<std::uint64_t, const RankedPoint*>> expected;  // curve positions, and the points of the same strata
    for (const RankedPoint& p : open) {
      if (box_.squaredExteriorDistance(position_of(p)) > kExpectedRange * kExpectedRange * fine_ * fine_) continue;
      const std::uint64_t own = p.curve_position >> shift, first = own / 4 * 4;
      for (std::uint64_t sibling = first; sibling < first + 4; ++sibling) {
        if (sibling != own) expected.emplace_back((sibling << shift) + (std::uint64_t{1} << (shift - 1)), &p);
      }
    }
    std::sort(expected.begin(), expected.end());
    std::vector<double> t;
    for (const auto& [middle, p] : expected) t.push_back(unit_curve_position(middle));
    std::vector<CurvePoint> at(t.size());
    strata.points_at(t, 0.25 / static_cast<double>(n_), at);
    for (std::size_t i = 0; i < at.size(); ++i) {
      std::copy_n(expected[i].second->normal, 3, at[i].normal);  // which side it is on
      others_.push_back({at[i], expected[i].first, 0});
    }
  }

  void find_around() {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> by_rank;
    for (std::uint32_t i = 0; i < points_.size() + others_.size(); ++i) by_rank.emplace_back(point(i).rank, i);
    std::sort(by_rank.begin(), by_rank.end());
    around_.resize(points_.size());
    felt_.resize(points_.size());
    constexpr std::size_t kUsual = 64;
    for (auto& list : around_) list.reserve(kUsual);
    for (std::size_t i = 0; i < felt_.size(); ++i) felt_[i].reserve(moves(i) ? kUsual : 0);
    std::vector<std::int32_t> is_near(points_.size());
    std::size_t count = 0;
    for (const auto& [rank, i] : by_rank) {
      Vec3f at = position_of(point(i));
      float reach = kGapRange * unit_ / std::sqrt(static_cast<float>(std::max<std::uint64_t>(rank, n_)));
      if (moves(i)) at = candidates_.child(i).centre, reach += candidates_.child(i).radius;
      if (box_.squaredExteriorDistance(at) > reach * reach) continue;
      candidates_.mark_near(at.data(), reach, is_near.data());
      const bool is_mover = moves(i);
      for_each_marked(is_near, [&, i = i](std::size_t c) {
        ++count;
        around_[c].push_back(i);
        if (is_mover) felt_[i].push_back(static_cast<std::uint32_t>(c));
      });
      is_crowded_ = count > kCrowd * points_.size();
      if (is_crowded_) return;
    }
  }

  /// Returns the widest gap at any time about a candidate of the child, and which candidate.
  BestCandidate widest_gap_in(std::size_t c) const {
    Row nearest, gap;
    nearest.fill(kFar);
    gap.fill(0);
    looks_ += around_[c].size();
    for (const std::uint32_t i : around_[c]) {
      const RankedPoint& p = point(i);
      if (p.rank >= n_) widen(gap.data(), nearest.data(), static_cast<float>(p.rank));
      candidates_.take_nearer(c, p, 1, nearest.data());
    }
    widen(gap.data(), nearest.data(), static_cast<float>(4 * n_));
    return best_candidate(gap.data(), gap.data(), 1);
  }

  /// Returns the widest gap at any time about any position in the child.
  float widest_gap_at(std::size_t c, const Vec3f& position) const {
    float nearest = kFar, gap = 0;
    for (const std::uint32_t i : around_[c]) {
      const RankedPoint& p = point(i);
      if (p.rank >= n_) gap = std::max(gap, nearest * static_cast<float>(p.rank));
      nearest = std::min(nearest, (position_of(p) - position).squaredNorm());
    }
    return std::max(gap, nearest * static_cast<float>(4 * n_));
  }

  float excess_of(std::size_t c) const {
    const float over = std::max(widest_gap_in(c).value / wide_ - 1, 0.0f);
    return over * over;
  }
  /// Returns by how much gaps are too wide in some children, added up until the sum reaches `most`.
  float excess(std::span<const std::pair<float, std::uint32_t>> children, float most) const {
    float sum = 0;
    for (auto c = children.begin(); c != children.end() && sum < most; ++c) sum += excess_of(c->second);
    return sum;
  }

  /// Returns for each candidate of child i the least squared distance from other points, times the number of points at that time.
  Row room(std::size_t i) const {
    Row least;
    least.fill(kFar);
    for (const std::uint32_t j : around_[i]) {
      if (j == i || j >= real_) continue;
      candidates_.take_nearer(i, point(j), static_cast<float>(std::max(point(j).rank, points_[i].rank) + 1), least.data());
    }
    return least;
  }

  /// Makes the one move of a point that lowers the excess of all gaps around most.
  void close(std::size_t c, const Vec3f& middle, float gap) {
    float gain = 0;
    std::size_t mover = 0, best_index = kCandidates;
    for (const std::uint32_t i : around_[c]) {
      if (looks_ > kMostLooks) break;
      if (!moves(i)) continue;
      const RankedPoint before = points_[i];
      const float square = (position_of(before) - middle).squaredNorm();
      // No farther than points beside the gap may be before it is filled.
      if (square * static_cast<float>(before.rank) > 2 * gap) continue;
      const Row least = room(i);
      float now = 0;
      std::vector<std::pair<float, std::uint32_t>>
          felt;  // widest gaps first: a bad move does not shrink them, and is found out early
      for (std::size_t k = 0; k < kCandidates; ++k) {
        if (least[k] < kKeptRelativeRadius * kKeptRelativeRadius * unit_ * unit_) continue;
        if ((position_of(candidates_.in_child(i), k) - middle).squaredNorm() >= square) continue;
        if (felt.empty()) {
          for (const std::uint32_t child : felt_[i]) felt.emplace_back(-excess_of(child), child);
          std::sort(felt.begin(), felt.end());
          for (const auto& [excess, child] : felt) now -= excess;
        }
        points_[i] = candidates_.point(i, k, before.rank);
        const float good = widest_gap_at(c, middle) < gap ? now - excess(felt, now - gain) : 0;
        if (good > gain) gain = good, mover = i, best_index = k;
        points_[i] = before;
      }
    }
    if (best_index < kCandidates) points_[mover] = candidates_.point(mover, best_index, points_[mover].rank);
  }

  const GroupCandidates& candidates_;
  std::span<RankedPoint> points_;
  std::uint64_t n_;    // strata of the level, and points of lower levels
  float fine_, unit_;  // lattice distances of 4 n points and of one
  float wide_;         // gaps with a larger measure are wide
  Eigen::AlignedBox3f box_;
  std::vector<RankedPoint> others_;
  std::size_t real_;                                // number of points that are not only expected; they come first
  std::vector<std::vector<std::uint32_t>> around_;  // for each child the points near it, by rank
  std::vector<std::vector<std::uint32_t>> felt_;    // for each point that moves the children near it
  mutable std::uint64_t looks_ = 0;                 // at points
  bool is_crowded_ = false;                         // around_ and felt_ do not hold all
};

}  // namespace

void shrink_gaps(const CurveStrata& strata, const GroupCandidates& candidates, std::span<const RankedPoint> done,
                 std::span<const RankedPoint> open, std::span<RankedPoint> points) {
  GapShrinker(strata, candidates, done, open, points).run();
}

}  // namespace curvecast
