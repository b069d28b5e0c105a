#include "client/bench/peers/triangle_random.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "core/base/random.h"

namespace curvecast::cli::bench {
namespace {

/// A random order of 0 .. n - 1 (Fisher and Yates).
std::vector<std::uint32_t> random_order(std::size_t n, std::uint64_t seed) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = n; i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<std::size_t>(random_unit(seed, i) * static_cast<double>(i))]);
  }
  return order;
}

/// How many of n points each face has.
std::vector<std::size_t> face_counts(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed) {
  const double per_area = static_cast<double>(n) / surface_area(mesh);
  std::vector<std::size_t> counts(mesh.face_count());
  std::vector<double> rests(mesh.face_count());  // in [0, 1)
  for (std::size_t f = 0; f < counts.size(); ++f) {
    const double wanted = per_area * triangle_area(mesh, f);
    counts[f] = static_cast<std::size_t>(wanted);
    rests[f] = wanted - std::floor(wanted);
  }
  const std::size_t placed = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  // Systematic sampling: `left` marks one apart along the rests, which add up to `left` but for rounding. A rest shorter than the
  // way from mark to mark is met once at most.
  const std::size_t left = n - std::min(n, placed);
  const double total = std::accumulate(rests.begin(), rests.end(), 0.0), step = total / static_cast<double>(left);
  const double start = random_unit(seed, 0);
  std::size_t marks = 0;
  double sum = 0;
  const std::vector<std::uint32_t> order = random_order(counts.size(), mix_bits(seed));
  for (const std::uint32_t f : order) {
    sum += rests[f];
    while (marks < left && (static_cast<double>(marks) + start) * step < sum) ++counts[f], ++marks;
  }
  // Rounding can leave the last mark beyond the end.
  for (; marks < left; ++marks) ++counts[order.back()];
  return counts;
}

}  // namespace

SurfacePoints triangle_random_points(const TriangleMesh& mesh, std::size_t n, std::uint64_t seed) {
  const std::vector<std::size_t> counts = face_counts(mesh, n, seed);
  const std::uint64_t place_seed = mix_bits(seed + 1);
  SurfacePoints points;
  for (std::uint32_t f = 0; f < counts.size(); ++f) {
    for (std::size_t k = 0; k < counts[f]; ++k) {
      const std::uint64_t i = points.faces.size();
      points.faces.push_back(f);
      points.positions.push_back(place_in_face(mesh, f, random_unit(place_seed, 2 * i), random_unit(place_seed, 2 * i + 1)));
    }
  }
  return points;
}

}  // namespace curvecast::cli::bench
