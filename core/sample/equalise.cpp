#include "core/sample/equalise.h"

#include <algorithm>
#include <cmath>

#include "core/lanes.h"

namespace curvecast {
namespace {

constexpr std::size_t kChunk = 256;  // points whose numbers stay in the nearest cache
constexpr float kBelowOne = 0x1.fffffep-1f;

/// Writes the mass before each block, and each block at the first of its points; blocks without points leave nothing behind. Which
/// blocks have points nobody can predict, and so no jump may depend on it.
void mark_blocks(const ViewMass& mass, std::span<const float> sums, std::span<const double> q, EqualiseScratch& scratch) {
  const std::size_t n = q.size();
  const double points_per_mass = static_cast<double>(n) / mass.total;
  scratch.before.resize(sums.size());
  scratch.block.assign(n + 1, 0);
  double* const before = scratch.before.data();
  std::uint32_t* const block = scratch.block.data();
  double after = 0;
  std::size_t count = 0;   // points before `after`
  std::uint32_t last = 0;  // block with mass
  for (std::uint32_t b = 0; b < sums.size(); ++b) {
    before[b] = after;
    block[count] = b;
    last = sums[b] > 0 ? b : last;
    after += static_cast<double>(sums[b]);
    count = std::min(static_cast<std::size_t>(after * points_per_mass), n - 1);
    count += q[count] * mass.total < after ? 1 : 0;
    // That does for sequences with one point in every N-th; the others are a few points ahead or behind.
    while (count < n && q[count] * mass.total < after) ++count;
    while (count > 0 && q[count - 1] * mass.total >= after) --count;
  }
  if (count < n) block[count] = last;  // by rounding
}

/// The part of its block's mass that lies before each of n points; `before` and `sums` are those of all blocks.
CURVECAST_WIDE void find_parts(const double* __restrict q, const std::uint32_t* __restrict block, const double* __restrict before,
                               const float* __restrict sums, double total, std::size_t n, float* __restrict part) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = static_cast<float>((q[i] * total - before[block[i]]) / static_cast<double>(sums[block[i]]));
    part[i] = p < kBelowOne ? p : kBelowOne;
  }
}

}  // namespace

void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices,
              EqualiseScratch& scratch) {
  if (!(mass.total > 0) || !std::isfinite(mass.total) || q.empty()) return;
  const std::span<const float> sums = mass.sums(fixed);
  mark_blocks(mass, sums, q, scratch);
  std::uint32_t* const block = scratch.block.data();
  float part[kChunk];
  std::uint32_t last = 0;
  for (std::size_t begin = 0; begin < q.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, q.size());
    for (std::size_t i = begin; i < end; ++i) block[i] = last = std::max(last, block[i]);
    find_parts(&q[begin], &block[begin], scratch.before.data(), sums.data(), mass.total, end - begin, part);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t b = block[i];
      vertices[i] = static_cast<std::uint32_t>(b * kBlockSize + mass.codes_of(fixed, b).vertex(part[i - begin]));
    }
  }
}

}  // namespace curvecast
