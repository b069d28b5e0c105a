#include "core/sample/view_mass.h"

#include <algorithm>
#include <bit>

#include "core/base/simd.h"

namespace curvecast {
namespace {

// Where a mass that varies along a block is spread by area instead, a quarter of its variation is misplaced at most: by no more
// than a quarter of a point here.
constexpr float kMovedPoints = 1;
// The whole mass is not exact. ViewMass::largest must be no larger than the true value: a curve that is refined for a vertex with
// too much mass, where there is none, would be refined for ever.
constexpr float kSurely = 0.98f;
constexpr std::size_t kBatch = 512;              // blocks whose factors are found in one go: they stay in the nearest cache
constexpr std::size_t kAhead = 2 * kBlockLanes;  // blocks that the memory brings beforehand

/// Blocks that are looked at vertex by vertex, several at once: what they hold of the curve, one after the other.
class CloseBlocks {
 public:
  CloseBlocks(const SurfaceCurve& curve, std::span<const float> density, const ViewFactor& view)
      : curve_(curve), density_(density), of_beside_(view.beside()) {}

  /// Has the memory bring a block.
  void prefetch(std::size_t block) const {
    const std::size_t begin = block * kBlockSize;
    for (const Column<float>* column : {&curve_.x, &curve_.y, &curve_.z, &curve_.area})
      __builtin_prefetch(column->data() + begin);
    for (const Column<Snorm16>* column : {&curve_.nx, &curve_.ny, &curve_.nz}) __builtin_prefetch(column->data() + begin);
    if (!density_.empty()) __builtin_prefetch(density_.data() + begin);
  }

  /// The masses of kBlockLanes blocks; of fewer, the last stand for nothing.
  void measure(std::span<const std::uint32_t> blocks, const ViewFactor& view, MassOfBlocks& out) {
    for (std::size_t k = 0; k < blocks.size(); ++k) take(blocks[k], k * kBlockSize);
    const VertexColumns vertices = {x_, y_, z_, nx_, ny_, nz_, of_beside_.empty() ? nullptr : beside_};
    view.multiply(vertices, blocks.size() * kBlockSize, mass_);
    float mass[kBlockSize][kBlockLanes] = {};
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      for (std::size_t i = 0; i < kBlockSize; ++i) mass[i][k] = mass_[k * kBlockSize + i];
    }
    sum_blocks(mass, out);
  }

 private:
  static constexpr std::size_t kVertices = kBlockLanes * kBlockSize;

  void take(std::size_t block, std::size_t to) {
    const std::size_t begin = block * kBlockSize;
    if (begin + kBlockSize <= curve_.size()) return copy(begin, kBlockSize, to);
    const std::size_t n = curve_.size() - begin;
    copy(begin, n, to);
    // The last block is filled up with copies of its first vertex, without mass.
    for (std::size_t i = to + n; i < to + kBlockSize; ++i) {
      x_[i] = x_[to], y_[i] = y_[to], z_[i] = z_[to], nx_[i] = nx_[to], ny_[i] = ny_[to], nz_[i] = nz_[to], mass_[i] = 0;
      beside_[i] = {};
    }
  }
  [[gnu::always_inline]] void copy(std::size_t begin, std::size_t n, std::size_t to) {
    std::copy_n(&curve_.x[begin], n, x_ + to);
    std::copy_n(&curve_.y[begin], n, y_ + to);
    std::copy_n(&curve_.z[begin], n, z_ + to);
    std::copy_n(&curve_.nx[begin], n, nx_ + to);
    std::copy_n(&curve_.ny[begin], n, ny_ + to);
    std::copy_n(&curve_.nz[begin], n, nz_ + to);
    if (!of_beside_.empty()) std::copy_n(&of_beside_[begin], n, beside_ + to);
    std::copy_n(&curve_.area[begin], n, mass_ + to);
    if (density_.empty()) return;
    for (std::size_t i = 0; i < n; ++i) mass_[to + i] *= density_[begin + i];
  }

  const SurfaceCurve& curve_;
  std::span<const float> density_;
  std::span<const Direction8> of_beside_;
  float x_[kVertices], y_[kVertices], z_[kVertices], mass_[kVertices];
  Snorm16 nx_[kVertices], ny_[kVertices], nz_[kVertices];
  Direction8 beside_[kVertices];
};

/// The sum of n numbers, in the same order everywhere.
CURVECAST_WIDE double sum_of(const float* values, std::size_t n) {
  double sums[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= n; i += 8) {
    for (std::size_t k = 0; k < 8; ++k) sums[k] += static_cast<double>(values[i + k]);
  }
  for (; i < n; ++i) sums[0] += static_cast<double>(values[i]);
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

/// Writes to `list` which values are larger than `most`, ascending, and returns how many. Most stretches have none.
std::size_t list_larger(std::span<const float> values, float most, std::uint32_t* list) {
  constexpr std::size_t kStretch = 16;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin < values.size(); begin += kStretch) {
    const std::size_t end = std::min(begin + kStretch, values.size());
    int any = 0;
    for (std::size_t i = begin; i < end; ++i) any |= values[i] > most ? 1 : 0;
    if (any == 0) continue;
    for (std::size_t i = begin; i < end; ++i) {
      list[count] = static_cast<std::uint32_t>(i);
      count += values[i] > most ? 1 : 0;
    }
  }
  return count;
}

/// Turns n blocks' factors into their masses, and their relative changes into masses. Returns what the largest mass on a vertex
/// is at least.
CURVECAST_WIDE float weigh(const float* __restrict fixed_sum, const float* __restrict fixed_largest, std::size_t n,
                           float* __restrict factor, float* __restrict change) {
  std::int32_t largest = 0;  // the bits of floats from 0 up ascend with them, and whole numbers compare in any order
  for (std::size_t i = 0; i < n; ++i) {
    const auto at_least = std::bit_cast<std::int32_t>(change[i] < 1 ? factor[i] * fixed_largest[i] * (1 - change[i]) : 0.0f);
    largest = at_least > largest ? at_least : largest;
    factor[i] *= fixed_sum[i];
    change[i] = factor[i] > 0 ? factor[i] * change[i] : 0.0f;  // without mass nothing moves, however near the outline
  }
  return std::bit_cast<float>(largest);
}

}  // namespace

void fixed_mass(const BlockMass& fixed, ViewMass& out) {
  out.sum.clear();
  out.codes.clear();
  out.own_codes.clear();
  out.total = fixed.total;
  out.largest = fixed.most;
}

void view_mass(const SurfaceCurve& curve, std::span<const float> density, const BlockMass& fixed, const ViewFactor& view,
               std::uint64_t points, ViewMass& out) {
  if (view.is_one()) return fixed_mass(fixed, out);
  const std::size_t blocks = fixed.sum.size();
  out.sum.resize(blocks);
  out.moved.resize(blocks);
  out.codes.assign(blocks, ViewMass::kShared);
  out.own_codes.clear();
  out.total = 0;
  out.largest = 0;
  for (std::size_t begin = 0; begin < blocks; begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, blocks);
    view.of_blocks(curve.blocks, begin, end, &out.sum[begin], &out.moved[begin]);
    const float largest = weigh(&fixed.sum[begin], &fixed.largest[begin], end - begin, &out.sum[begin], &out.moved[begin]);
    out.largest = std::max(out.largest, largest);
    out.total += sum_of(&out.sum[begin], end - begin);
  }
  // How much lies on one point is known only when all is summed, but well enough already.
  const auto most = static_cast<float>(kMovedPoints * out.total / static_cast<double>(points));
  out.close.resize(blocks);
  const std::size_t count = list_larger(out.moved, most, out.close.data());
  const std::uint32_t* const close = out.close.data();
  CloseBlocks looked_at(curve, density, view);
  MassOfBlocks masses;
  out.own_codes.resize(count);
  for (std::size_t i = 0; i < std::min(count, kAhead); ++i) looked_at.prefetch(close[i]);
  for (std::size_t first = 0; first < count; first += kBlockLanes) {
    const std::size_t n = std::min(kBlockLanes, count - first);
    for (std::size_t i = first + kAhead; i < std::min(count, first + kAhead + n); ++i) looked_at.prefetch(close[i]);
    looked_at.measure({close + first, n}, view, masses);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t b = close[first + k];
      out.total += static_cast<double>(masses.sum[k]) - static_cast<double>(out.sum[b]);
      out.sum[b] = masses.sum[k];
      out.largest = std::max(out.largest, masses.largest[k]);
      out.codes[b] = static_cast<std::uint32_t>(first + k);
      out.own_codes[first + k] = masses.codes[k];
    }
  }
  out.largest *= kSurely;
}

}  // namespace curvecast
