#include "core/sample/equalise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace curvecast {
namespace {

// Vertices summed at once: sums of blocks are found without waiting for one another, and most steps skip a block.
constexpr std::size_t kBlock = 64;

double block_mass(std::span<const float> density, std::span<const float> area, std::size_t begin, float* largest) {
  const std::size_t end = std::min(begin + kBlock, density.size());
  double sum = 0;
  float most = 0;  // the block's own: blocks do not wait for one another
  for (std::size_t l = begin; l < end; ++l) {
    const float mass = density[l] * area[l];
    most = std::max(most, mass);
    sum += static_cast<double>(mass);
  }
  *largest = std::max(*largest, most);
  return sum;
}

}  // namespace

Mass equalise(std::span<const float> density, std::span<const float> area, std::span<const double> q,
              std::span<std::uint32_t> vertices) {
  const std::size_t blocks = (density.size() + kBlock - 1) / kBlock;
  std::vector<double> before(blocks + 1, 0.0);  // cumulative, at the blocks' beginnings
  Mass whole;
  for (std::size_t b = 0; b < blocks; ++b) before[b + 1] = before[b] + block_mass(density, area, b * kBlock, &whole.largest);
  const double total = before[blocks];
  whole.total = total;
  if (!(total > 0) || !std::isfinite(total)) return whole;
  std::uint32_t last = 0;  // with density
  std::size_t i = 0;
  for (std::size_t b = 0; b < blocks && i < q.size(); ++b) {
    if (before[b + 1] == before[b]) continue;
    if (q[i] * total >= before[b + 1] && before[b + 1] < total) continue;
    const std::size_t end = std::min((b + 1) * kBlock, density.size());
    double sum = before[b];
    for (std::size_t l = b * kBlock; l < end; ++l) {
      const float mass = density[l] * area[l];
      if (!(mass > 0)) continue;
      sum += static_cast<double>(mass);
      last = static_cast<std::uint32_t>(l);
      while (i < q.size() && q[i] * total < sum) vertices[i++] = last;
    }
    // Within a block the sum is rounded in another order: what falls between the two sums belongs to its last vertex.
    while (i < q.size() && q[i] * total < before[b + 1]) vertices[i++] = last;
  }
  while (i < q.size()) vertices[i++] = last;
  return whole;
}

}  // namespace curvecast
