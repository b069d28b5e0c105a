#include "core/flatten/square_border.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace curvecast {
namespace {

// Corners are chosen by how square they are, less this much of the square of how far they went, as a part of how far they may.
constexpr double kCostOfPlay = 0.5;
constexpr double kSide = 0.025;  // of the border: how much of it on either side tells how it turns

/// The vertices of a border, counted on and on around it in both directions.
class Around {
 public:
  using Index = std::ptrdiff_t;

  explicit Around(const DiscMesh& disc) : disc_(disc), size_(static_cast<Index>(disc.border.size())), along_{0.0} {
    double length = 0;
    for (Index i = 0; i < size_; ++i) length += edge(i);
    // No edge may vanish beside much longer ones.
    const double least = 1e-3 * length / static_cast<double>(size_);
    for (Index i = 0; i < size_; ++i) along_.push_back(along_.back() + std::max(edge(i), least));
  }

  Index size() const { return size_; }
  double length() const { return along_.back(); }
  std::uint32_t vertex(Index i) const { return disc_.border[static_cast<std::size_t>(i - size_ * laps(i))]; }
  const Vec3d& position(Index i) const { return disc_.positions[vertex(i)]; }
  /// The length of the border from vertex 0 on.
  double along(Index i) const {
    return along_[static_cast<std::size_t>(i - size_ * laps(i))] + static_cast<double>(laps(i)) * length();
  }
  /// The vertex nearest to a place, given as along().
  Index nearest(double place) const {
    const double laps = length() > 0 ? std::floor(place / length()) : 0, rest = place - laps * length();
    auto above = std::lower_bound(along_.begin(), along_.end() - 1, rest);
    if (above != along_.begin() && rest - above[-1] < *above - rest) --above;
    const Index i = above - along_.begin();
    return i + static_cast<Index>(laps) * size_;
  }

 private:
  Index laps(Index i) const { return i >= 0 ? i / size_ : -1 - (-1 - i) / size_; }
  double edge(Index i) const { return (position(i + 1) - position(i)).norm(); }

  const DiscMesh& disc_;
  Index size_;
  std::vector<double> along_;
};

/// How much like the corner of a square the border is at a vertex: 0 for a right angle, -1 where it goes straight on, or turns
/// away from the middle.
double squareness(const Around& border, Around::Index i, const Vec3d& middle) {
  const double side = kSide * border.length();
  const Vec3d& corner = border.position(i);
  const Vec3d before = border.position(border.nearest(border.along(i) - side)) - corner;
  const Vec3d after = border.position(border.nearest(border.along(i) + side)) - corner;
  const double scale = before.norm() * after.norm();
  if (!(scale > 0) || (before + after).dot(middle - corner) <= 0) return -1;
  return -std::abs(before.dot(after) / scale);
}

/// The best place for a corner within `play` of the border's length from `target`.
Around::Index squarest(const Around& border, double target, double play, const Vec3d& middle) {
  const double reach = play * border.length();
  Around::Index best = border.nearest(target);
  double most = -std::numeric_limits<double>::infinity();
  for (Around::Index i = border.nearest(target - reach); i <= border.nearest(target + reach); ++i) {
    const double away = (border.along(i) - target) / reach;
    if (const double worth = squareness(border, i, middle) - kCostOfPlay * away * away; worth > most) most = worth, best = i;
  }
  return best;
}

}  // namespace

std::vector<Vec2d> square_border(const DiscMesh& disc, double play) {
  const Around border(disc);
  Vec3d middle = Vec3d::Zero();
  for (Around::Index i = 0; i < border.size(); ++i) middle += border.position(i) / static_cast<double>(border.size());
  std::array<Around::Index, 5> corner = {};
  for (int k = 0; k < 4; ++k) {
    const double target = border.length() * k / 4;
    Around::Index& here = corner[static_cast<std::size_t>(k)];
    here = play > 0 ? squarest(border, target, play, middle) : border.nearest(target);
    if (k > 0) here = std::clamp(here, corner[static_cast<std::size_t>(k) - 1] + 1, corner[0] + border.size() - 4 + k);
  }
  corner[4] = corner[0] + border.size();
  std::vector<Vec2d> uv(disc.vertex_count(), Vec2d::Zero());
  const std::array<Vec2d, 5> place = {Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1), Vec2d(0, 0)};
  for (std::size_t k = 0; k < 4; ++k) {
    const double begin = border.along(corner[k]), length = border.along(corner[k + 1]) - begin;
    for (Around::Index i = corner[k]; i < corner[k + 1]; ++i) {
      uv[border.vertex(i)] = place[k] + (border.along(i) - begin) / length * (place[k + 1] - place[k]);
    }
  }
  return uv;
}

}  // namespace curvecast
