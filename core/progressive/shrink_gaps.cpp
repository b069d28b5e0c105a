#include "core/progressive/rank_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/lanes.h"

namespace curvecast {
namespace {

constexpr float kReach = 1.1f;    // in lattice distances: points farther from a place leave a hole there anyway
constexpr float kApart = 0.52f;   // relative radius that points keep
constexpr float kExpected = 3;    // in fine lattice distances: how far strata may be whose points to come are thought of
constexpr float kOneHole = 0.5f;  // in the same: wide places nearer than that are one hole

using Row = std::array<float, kCandidates>;

/// Holes of square radius `nearest` when there are n points.
CURVECAST_WIDE void widen(float* hole, const float* nearest, float n) {
  for (std::size_t k = 0; k < kCandidates; ++k) {
    const float h = nearest[k] * n;
    hole[k] = h > hole[k] ? h : hole[k];
  }
}

Vec3f position_of(const RankedPoint& p) { return {p.position[0], p.position[1], p.position[2]}; }
Vec3f position_of(const CandidatePoints& candidates, std::size_t k) {
  return {candidates.x[k], candidates.y[k], candidates.z[k]};
}

/// Calls visit(i) for the entries that are marked, few and in runs.
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

/// Holes are square radii times the number of points there are.
class HoleCloser {
 public:
  HoleCloser(const CurveStrata& strata, const GroupCandidates& candidates, std::span<const RankedPoint> done,
             std::span<const RankedPoint> open, std::span<RankedPoint> points)
      : candidates_(candidates),
        points_(points),
        n_(std::uint64_t{1} << 2 * candidates.block().level),
        fine_(lattice_distance(candidates.total_area(), static_cast<double>(4 * n_))),
        unit_(lattice_distance(candidates.total_area(), 1)),
        wide_(kWideHole * kWideHole * unit_ * unit_),
        box_(candidates.box()),
        others_(done.begin(), done.end()) {
    others_.insert(others_.end(), open.begin(), open.end());
    real_ = points_.size() + others_.size();
    expect_points(strata, open);
    find_around();
  }

  void run() {
    std::vector<std::pair<float, std::size_t>> widest;
    for (std::size_t c = 0; c < around_.size(); ++c) {
      const float hole = hole_in(c).value;
      if (hole > wide_) widest.emplace_back(-hole, c);
    }
    std::sort(widest.begin(), widest.end());
    std::vector<Vec3f> tried;
    for (const auto& [hole, c] : widest) {
      const BestCandidate now = hole_in(c);
      const Vec3f middle = position_of(candidates_.in_child(c), now.index);
      const auto is_same = [&](const Vec3f& x) { return (x - middle).squaredNorm() < kOneHole * kOneHole * fine_ * fine_; };
      if (now.value <= wide_ || std::any_of(tried.begin(), tried.end(), is_same)) continue;
      tried.push_back(middle);
      close(c, middle, now.value);
    }
  }

 private:
  /// The block's points, those of other blocks, and those that are to come there.
  const RankedPoint& point(std::size_t i) const { return i < points_.size() ? points_[i] : others_[i - points_.size()]; }
  bool moves(std::size_t i) const { return i < points_.size() && points_[i].rank >= n_; }

  /// Of the points that are to come in open blocks one knows the strata: they count as there, in the middle.
  void expect_points(const CurveStrata& strata, std::span<const RankedPoint> open) {
    const int shift = child_shift(candidates_.block().level);
    for (const RankedPoint& p : open) {
      if (box_.squaredExteriorDistance(position_of(p)) > kExpected * kExpected * fine_ * fine_) continue;
      const std::uint64_t own = p.coordinate >> shift, first = own / 4 * 4;
      for (std::uint64_t sibling = first; sibling < first + 4; ++sibling) {
        if (sibling == own) continue;
        const std::uint64_t middle = (sibling << shift) + (std::uint64_t{1} << (shift - 1));
        const std::uint32_t vertex = strata.vertex_at(curve_coordinate(middle));
        const Vec3f x = strata.curve().position(vertex);
        others_.push_back({middle, {x.x(), x.y(), x.z()}, {p.normal[0], p.normal[1], p.normal[2]}, vertex, 0});
      }
    }
  }

  void find_around() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_rank;
    for (std::uint32_t i = 0; i < points_.size() + others_.size(); ++i) by_rank.emplace_back(point(i).rank, i);
    std::sort(by_rank.begin(), by_rank.end());
    around_.resize(points_.size());
    felt_.resize(points_.size());
    constexpr std::size_t kUsual = 64;
    for (auto& list : around_) list.reserve(kUsual);
    for (std::size_t i = 0; i < felt_.size(); ++i) felt_[i].reserve(moves(i) ? kUsual : 0);
    std::vector<std::int32_t> is_near(points_.size());
    for (const auto& [rank, i] : by_rank) {
      Vec3f at = position_of(point(i));
      float reach = kReach * unit_ / std::sqrt(static_cast<float>(std::max<std::uint64_t>(rank, n_)));
      if (moves(i)) at = candidates_.child(i).center, reach += candidates_.child(i).radius;
      if (box_.squaredExteriorDistance(at) > reach * reach) continue;
      candidates_.mark_near(at.data(), reach, is_near.data());
      const bool is_mover = moves(i);
      for_each_marked(is_near, [&, i = i](std::size_t c) {
        around_[c].push_back(i);
        if (is_mover) felt_[i].push_back(static_cast<std::uint32_t>(c));
      });
    }
  }

  /// The widest about a place of the child, of all times, and which place it is.
  BestCandidate hole_in(std::size_t c) const {
    Row nearest, hole;
    nearest.fill(kFar);
    hole.fill(0);
    for (const std::uint32_t i : around_[c]) {
      const RankedPoint& p = point(i);
      if (p.rank >= n_) widen(hole.data(), nearest.data(), static_cast<float>(p.rank));
      candidates_.take_nearer(c, p, 1, nearest.data());
    }
    widen(hole.data(), nearest.data(), static_cast<float>(4 * n_));
    return best_candidate(hole.data(), hole.data(), 1);
  }

  /// The same about a place anywhere in the child.
  float hole_at(std::size_t c, const Vec3f& place) const {
    float nearest = kFar, hole = 0;
    for (const std::uint32_t i : around_[c]) {
      const RankedPoint& p = point(i);
      if (p.rank >= n_) hole = std::max(hole, nearest * static_cast<float>(p.rank));
      nearest = std::min(nearest, (position_of(p) - place).squaredNorm());
    }
    return std::max(hole, nearest * static_cast<float>(4 * n_));
  }

  float excess_of(std::size_t c) const {
    const float over = std::max(hole_in(c).value / wide_ - 1, 0.0f);
    return over * over;
  }
  /// By how much holes are too wide in some children; no more of it than `most`.
  float excess(std::span<const std::pair<float, std::uint32_t>> children, float most) const {
    float sum = 0;
    for (auto c = children.begin(); c != children.end() && sum < most; ++c) sum += excess_of(c->second);
    return sum;
  }

  /// Where in its child a point would have how much room.
  Row room(std::size_t i) const {
    Row least;
    least.fill(kFar);
    for (const std::uint32_t j : around_[i]) {
      if (j == i || j >= real_) continue;
      candidates_.take_nearer(i, point(j), static_cast<float>(std::max(point(j).rank, points_[i].rank) + 1), least.data());
    }
    return least;
  }

  /// Makes the one move that does most good.
  void close(std::size_t c, const Vec3f& middle, float hole) {
    float gain = 0;
    std::size_t mover = 0, best_index = kCandidates;
    for (const std::uint32_t i : around_[c]) {
      if (!moves(i)) continue;
      const RankedPoint before = points_[i];
      const float square = (position_of(before) - middle).squaredNorm();
      // As far as points may be that are beside the hole before it closes.
      if (square * static_cast<float>(before.rank) > 2 * hole) continue;
      const Row least = room(i);
      float now = 0;
      std::vector<std::pair<float, std::uint32_t>> felt;  // the worst first, which a bad move makes no better
      for (std::size_t k = 0; k < kCandidates; ++k) {
        if (least[k] < kApart * kApart * unit_ * unit_) continue;
        if ((position_of(candidates_.in_child(i), k) - middle).squaredNorm() >= square) continue;
        if (felt.empty()) {
          for (const std::uint32_t child : felt_[i]) felt.emplace_back(-excess_of(child), child);
          std::sort(felt.begin(), felt.end());
          for (const auto& [excess, child] : felt) now -= excess;
        }
        points_[i] = candidates_.point(i, k, before.rank);
        const float good = hole_at(c, middle) < hole ? now - excess(felt, now - gain) : 0;
        if (good > gain) gain = good, mover = i, best_index = k;
        points_[i] = before;
      }
    }
    if (best_index < kCandidates) points_[mover] = candidates_.point(mover, best_index, points_[mover].rank);
  }

  const GroupCandidates& candidates_;
  std::span<RankedPoint> points_;
  std::uint64_t n_;    // strata of the level
  float fine_, unit_;  // lattice distances of 4 n points and of one
  float wide_;         // a hole from which on it is
  Eigen::AlignedBox3f box_;
  std::vector<RankedPoint> others_;
  std::size_t real_;                                // points that there are, before those that are to come
  std::vector<std::vector<std::uint32_t>> around_;  // each child: points, by rank
  std::vector<std::vector<std::uint32_t>> felt_;    // each point that moves: children
};

}  // namespace

void close_holes(const CurveStrata& strata, const GroupCandidates& candidates, std::span<const RankedPoint> done,
                 std::span<const RankedPoint> open, std::span<RankedPoint> points) {
  HoleCloser(strata, candidates, done, open, points).run();
}

}  // namespace curvecast
