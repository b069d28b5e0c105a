#include "core/sample/equalise.h"

#include <algorithm>
#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlocks = 512, kPoints = 256;  // done in one go: what is made of them stays in the nearest cache
constexpr float kBelowOne = 0x1.fffffep-1f;

/// Some blocks that follow one another, and their points.
struct Stretch {
  std::size_t begin, end;             // blocks
  double mass[kBlocks + 1];           // before each, and through the last
  std::uint32_t points[kBlocks + 1];  // before as much of the mass

  std::size_t size() const { return end - begin; }
};

/// Says whether each N-th of [0, 1) has one q, as jitter leaves them, but for rounding.
CURVECAST_WIDE bool is_stratified(std::span<const double> q) {
  constexpr double kSlack = 1e-6;
  const auto n = static_cast<double>(q.size());
  std::int64_t astray = 0;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(q.size()); ++i) {
    const double within = q[static_cast<std::size_t>(i)] * n - static_cast<double>(i);
    astray |= within > -kSlack && within < 1 + kSlack ? 0 : 1;
  }
  return astray == 0;
}

/// Counts the points before each of a stretch's masses: right where q is stratified, else about right.
CURVECAST_WIDE void count_points(const double* __restrict q, std::size_t size, double total, Stretch& stretch) {
  const double last = static_cast<double>(size) - 1, points_per_mass = static_cast<double>(size) / total;
  const double* __restrict const mass = stretch.mass;
  std::uint32_t* __restrict const points = stretch.points;
  for (std::size_t b = 0; b <= stretch.size(); ++b) {
    const auto count = static_cast<std::int32_t>(fast_min(mass[b] * points_per_mass, last));
    points[b] = static_cast<std::uint32_t>(count) + (q[count] * total < mass[b] ? 1 : 0);
  }
}

/// Puts right what other sequences make wrong: their points are a few ahead or behind.
void recount_points(std::span<const double> q, double total, Stretch& stretch) {
  for (std::size_t b = 0; b <= stretch.size(); ++b) {
    std::uint32_t& count = stretch.points[b];
    while (count < q.size() && q[count] * total < stretch.mass[b]) ++count;
    while (count > 0 && q[count - 1] * total >= stretch.mass[b]) --count;
  }
}

/// Writes to `block` each block at the first of its points, counted from the stretch's first; blocks without points leave nothing
/// behind. Which blocks have points cannot be predicted, so no jump may depend on it.
void mark_blocks(const Stretch& stretch, std::vector<std::uint32_t>& block) {
  const std::uint32_t first = stretch.points[0];
  block.assign(stretch.points[stretch.size()] - first + 1, 0);
  for (std::size_t b = 0; b < stretch.size(); ++b) block[stretch.points[b] - first] = static_cast<std::uint32_t>(b);
}

/// What part of its block's mass lies before each of n points, as MassCodes have it; `before` and `sums` are those of the
/// stretch's blocks.
CURVECAST_WIDE void find_parts(const double* __restrict q, const std::uint32_t* __restrict block, const double* __restrict before,
                               const float* __restrict sums, double total, std::size_t n, std::int32_t* __restrict part) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = static_cast<float>((q[i] * total - before[block[i]]) / static_cast<double>(sums[block[i]]));
    part[i] = MassCodes::part(p < kBelowOne ? p : kBelowOne);
  }
}

}  // namespace

void equalise(const ViewMass& mass, const BlockMass& fixed, std::span<const double> q, std::span<std::uint32_t> vertices,
              EqualiseScratch& scratch) {
  if (!(mass.total > 0) || !std::isfinite(mass.total) || q.empty()) return;
  const std::span<const float> sums = mass.sums(fixed);
  const bool recount = !is_stratified(q);
  Stretch stretch;
  stretch.begin = 0;
  stretch.mass[0] = 0;
  std::int32_t part[kPoints];
  std::size_t first = 0;
  for (; stretch.begin < sums.size() && first < q.size(); stretch.begin = stretch.end) {
    stretch.end = std::min(stretch.begin + kBlocks, sums.size());
    for (std::size_t b = 0; b < stretch.size(); ++b) {
      stretch.mass[b + 1] = stretch.mass[b] + static_cast<double>(sums[stretch.begin + b]);
    }
    count_points(q.data(), q.size(), mass.total, stretch);
    if (recount) recount_points(q, mass.total, stretch);
    mark_blocks(stretch, scratch.block);
    const std::size_t end = stretch.points[stretch.size()];
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
    stretch.mass[0] = stretch.mass[stretch.size()];
  }
  if (first == q.size()) return;
  // Left over by rounding: on the last block with mass.
  std::size_t b = sums.size() - 1;
  while (b > 0 && !(sums[b] > 0)) --b;
  const std::size_t vertex = b * kBlockSize + mass.codes_of(fixed, b).vertex(MassCodes::part(kBelowOne));
  std::fill(vertices.begin() + static_cast<std::ptrdiff_t>(first), vertices.end(), static_cast<std::uint32_t>(vertex));
}

}  // namespace curvecast
