#include "core/sample/equalise.h"

#include <algorithm>
#include <cmath>

#include "core/branchless.h"
#include "core/lanes.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlocks = 512, kPoints = 256;  // done in one go: what is made of them stays in the nearest cache
constexpr float kBelowOne = 0x1.fffffep-1f;

/// Some blocks that follow one another, and their points.
struct Stretch {
  std::size_t begin, end;    // blocks
  double mass[kBlocks + 1];  // before each, and through the last
};

/// Writes the masses before the blocks, and to `block` each block at the first of its points, counted from `first`; blocks
/// without points leave nothing behind. Which blocks have points nobody can predict, and so no jump may depend on it. Returns the
/// number of points through the last block.
std::size_t mark_blocks(std::span<const float> sums, std::span<const double> q, double total, std::size_t first, Stretch& stretch,
                        std::vector<std::uint32_t>& block) {
  const std::size_t n = stretch.end - stretch.begin;
  const auto last = static_cast<double>(q.size() - 1), points_per_mass = static_cast<double>(q.size()) / total;
  const auto points_before = [&](double mass) {
    auto count = static_cast<std::size_t>(lesser(mass * points_per_mass, last));
    count += q[count] * total < mass ? 1 : 0;
    // That does for sequences with one point in every N-th; the others are a few points ahead or behind.
    while (count < q.size() && q[count] * total < mass) ++count;
    while (count > 0 && q[count - 1] * total >= mass) --count;
    return count;
  };
  double* const mass = stretch.mass;
  for (std::size_t b = 0; b < n; ++b) mass[b + 1] = mass[b] + static_cast<double>(sums[stretch.begin + b]);
  block.assign(points_before(mass[n]) - first + 1, 0);
  std::size_t count = first;
  for (std::size_t b = 0; b < n; ++b) {
    block[count - first] = static_cast<std::uint32_t>(b);
    count = points_before(mass[b + 1]);
  }
  return count;
}

/// The part of its block's mass that lies before each of n points; `before` and `sums` are those of the stretch's blocks.
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
  Stretch stretch{};
  float part[kPoints];
  std::size_t first = 0;
  for (; stretch.begin < sums.size() && first < q.size(); stretch.begin = stretch.end) {
    stretch.end = std::min(stretch.begin + kBlocks, sums.size());
    const std::size_t end = mark_blocks(sums, q, mass.total, first, stretch, scratch.block);
    std::uint32_t last = 0;
    for (std::size_t begin = first; begin < end; begin += kPoints) {
      const std::size_t count = std::min(kPoints, end - begin);
      std::uint32_t* const block = &scratch.block[begin - first];
      for (std::size_t i = 0; i < count; ++i) block[i] = last = std::max(last, block[i]);
      find_parts(&q[begin], block, stretch.mass, &sums[stretch.begin], mass.total, count, part);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t b = stretch.begin + block[i];
        vertices[begin + i] = static_cast<std::uint32_t>(b * kBlockSize + mass.codes_of(fixed, b).vertex(part[i]));
      }
    }
    first = end;
    stretch.mass[0] = stretch.mass[stretch.end - stretch.begin];
  }
  if (first == q.size()) return;
  // Left over by rounding: on the last block with mass.
  std::size_t b = sums.size() - 1;
  while (!(sums[b] > 0)) --b;
  const std::size_t vertex = b * kBlockSize + mass.codes_of(fixed, b).vertex(kBelowOne);
  std::fill(vertices.begin() + static_cast<std::ptrdiff_t>(first), vertices.end(), static_cast<std::uint32_t>(vertex));
}

}  // namespace curvecast
