#include "core/curve/leaf_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curvecast {
namespace {

constexpr std::size_t kReach = 2;      // vertices before and after
constexpr float kFarthest = 3;         // of them, in leaf sizes
constexpr float kMostArea = 2;         // of a frame, over the leaf's own
constexpr float kLeastSpread = 0.01f;  // of the neighbours across the direction in which they lie
constexpr int kSubcellLevels = 4;      // a leaf is taken as so many levels of quads more
constexpr int kSubcells = 1 << 2 * kSubcellLevels;

struct Offset {
  float x, y;
};

/// From the middle of a square of size 1 to those of its subcells, in curve order, for each state.
constexpr auto kSubcellOffsets = [] {
  std::array<std::array<Offset, kSubcells>, 4> offsets{};
  for (HilbertState start = 0; start < 4; ++start) {
    for (unsigned i = 0; i < kSubcells; ++i) {
      HilbertState state = start;
      float half = 0.25f;
      for (int shift = 2 * kSubcellLevels - 2; shift >= 0; shift -= 2, half *= 0.5f) {
        const unsigned quadrant = hilbert_quadrant(state, i >> shift & 3);
        offsets[start][i].x += quadrant & 1 ? half : -half;
        offsets[start][i].y += quadrant & 2 ? half : -half;
        state = hilbert_child_state(state, i >> shift & 3);
      }
    }
  }
  return offsets;
}();

}  // namespace

Vec3f LeafFrame::offset(double part) const {
  const double subcell = std::clamp(part * kSubcells, 0.0, kSubcells - 1.0);
  const Offset at = kSubcellOffsets[state][static_cast<std::size_t>(subcell)];
  return at.x * along_x + at.y * along_y;
}

LeafFrames::LeafFrames(const SurfaceCurve& curve) : curve_(&curve) { known_.fill(std::numeric_limits<std::size_t>::max()); }

LeafFrame LeafFrames::of(std::size_t l) {
  const Quad own = quad(l);
  LeafFrame frame{.state = own.state};
  const auto disc = std::upper_bound(curve_->disc_begin.begin(), curve_->disc_begin.end(), l);
  const std::size_t begin = *(disc - 1), end = *disc;
  float xx = 0, xy = 0, yy = 0;
  Vec3f px = Vec3f::Zero(), py = Vec3f::Zero();
  for (std::size_t j = std::max(begin + kReach, l) - kReach; j < std::min(end, l + kReach + 1); ++j) {
    const Quad& other = quad(j);
    const auto x = static_cast<float>((other.x - own.x) / own.size), y = static_cast<float>((other.y - own.y) / own.size);
    const float square = x * x + y * y;
    if (square == 0 || square > kFarthest * kFarthest) continue;
    const Vec3f step = (curve_->position(j) - curve_->position(l)) / square;
    xx += x * x / square;
    xy += x * y / square;
    yy += y * y / square;
    px += x * step;
    py += y * step;
  }
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > kLeastSpread * (xx + yy) * (xx + yy))) return frame;
  const Vec3f along_x = (yy * px - xy * py) / determinant, along_y = (xx * py - xy * px) / determinant;
  // Where neighbours lie beyond a crease they do not tell how the leaf lies.
  if (!(along_x.cross(along_y).norm() <= kMostArea * curve_->area[l])) return frame;
  frame.along_x = along_x;
  frame.along_y = along_y;
  return frame;
}

const LeafFrames::Quad& LeafFrames::quad(std::size_t l) {
  const std::size_t slot = l % quads_.size();
  if (known_[slot] == l) return quads_[slot];
  known_[slot] = l;
  const int level = curve_->level[l];
  const std::uint64_t index = curve_->key[l] >> 2 * (kMaxLevel - level);
  HilbertState state = 0;
  std::uint32_t x = 0, y = 0;
  for (int shift = 2 * level - 2; shift >= 0; shift -= 2) {
    const auto i = static_cast<unsigned>(index >> shift & 3);
    const unsigned quadrant = hilbert_quadrant(state, i);
    x = x << 1 | (quadrant & 1);
    y = y << 1 | quadrant >> 1;
    state = hilbert_child_state(state, i);
  }
  const double size = 1 / static_cast<double>(std::uint64_t{1} << level);
  quads_[slot] = {(x + 0.5) * size, (y + 0.5) * size, size, state};
  return quads_[slot];
}

}  // namespace curvecast
