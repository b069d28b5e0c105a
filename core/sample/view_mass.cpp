#include "core/sample/view_mass.h"

#include <algorithm>
#include <bit>

#include "core/lanes.h"

namespace curvecast {
namespace {

// Where a mass that varies along a block is spread by area instead, a quarter of its variation is misplaced at most: by no more
// than a quarter of a point here.
constexpr float kMovedPoints = 1;
// The whole mass is not exact, and those who compare one vertex with it must not find too much on it: what is refined in vain
// would be refined for ever.
constexpr float kSurely = 0.98f;
constexpr std::size_t kChunk = 512;  // blocks whose factors are found in one go: they stay in the nearest cache

/// The masses of a block's vertices, one by one.
MassOfBlock look_closely(const SurfaceCurve& curve, std::span<const float> density, const ViewFactor& view, std::size_t block) {
  const std::size_t begin = block * kBlockSize, n = std::min(kBlockSize, curve.size() - begin);
  float mass[kBlockSize];
  for (std::size_t i = 0; i < n; ++i)
    mass[i] = density.empty() ? curve.area[begin + i] : density[begin + i] * curve.area[begin + i];
  view.multiply(&curve.x[begin], &curve.y[begin], &curve.z[begin], &curve.nx[begin], &curve.ny[begin], &curve.nz[begin], n, mass);
  return sum_block(mass, n);
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
  for (std::size_t begin = 0; begin < blocks; begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, blocks);
    view.of_blocks(curve.blocks, begin, end, &out.sum[begin], &out.moved[begin]);
    const float largest = weigh(&fixed.sum[begin], &fixed.largest[begin], end - begin, &out.sum[begin], &out.moved[begin]);
    out.largest = std::max(out.largest, largest);
    for (std::size_t b = begin; b < end; ++b) out.total += static_cast<double>(out.sum[b]);
  }
  // How much lies on one point is known only when all is summed, but well enough already.
  const auto most = static_cast<float>(kMovedPoints * out.total / static_cast<double>(points));
  out.close.resize(blocks);
  std::size_t count = 0;
  const float* const moved = out.moved.data();
  std::uint32_t* const close = out.close.data();
  for (std::size_t b = 0; b < blocks; ++b) {
    close[count] = static_cast<std::uint32_t>(b);
    count += moved[b] > most ? 1 : 0;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t b = close[i];
    const MassOfBlock block = look_closely(curve, density, view, b);
    out.total += static_cast<double>(block.sum) - static_cast<double>(out.sum[b]);
    out.sum[b] = block.sum;
    out.largest = std::max(out.largest, block.largest);
    out.codes[b] = static_cast<std::uint32_t>(out.own_codes.size());
    out.own_codes.push_back(block.codes);
  }
  out.largest *= kSurely;
}

}  // namespace curvecast
