// Points in space sorted into small runs of neighbours: the leaves of trees of boxes, and what a query takes or leaves at once.
// Source: Bentley, "Multidimensional binary search trees used for associative searching" (1975).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

/// How n things in order are cut into runs of at most `size`, filled evenly.
struct Runs {
  std::size_t n, count;

  Runs(std::size_t things, std::size_t size) : n(things), count((things + size - 1) / size) {}
  std::size_t begin(std::size_t run) const { return run * n / count; }
  std::size_t end(std::size_t run) const { return begin(run + 1); }
};

/// Lists all indices of the points (finite, at most 2^32 - 1), run after run of Runs(points.size(), size): halved through the
/// median of the longest side of their box again and again, so that every run and every 2^k runs from a multiple of 2^k on are
/// compact. The same for any number of threads.
std::vector<std::uint32_t> kd_order(std::span<const Vec3d> points, std::size_t size);

}  // namespace curvecast
