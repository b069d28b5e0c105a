// How evenly samples lie on a mesh: its discrepancy over regions grown in rings of triangles (paper, section 4.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/measure/discrepancy.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Returns the numbers of samples of the paper's test that are at most `most`: 2^l and 2^l + 2^(l - 1), l = 1 .. 20, ascending.
std::vector<double> ring_set_sizes(std::uint64_t most);

struct RingDiscrepancyOptions {
  int regions = 256;       // seed triangles, chosen at random, >= 1
  std::uint64_t seed = 0;  // of the choice
  /// What samples of each face (F values, >= 0, not all of them zero) are to be to those of others; empty = uniform.
  std::span<const double> face_density;
};

/// Measures each set of samples, given as their faces (TriangleTree finds those of any points), over all regions.
/// Around a seed triangle the first ring is all triangles that share a corner with it, and so on until the seed's component is
/// whole: the region after each ring, the seed alone as well, is a subset. The maximum is over all subsets; in the RMS every seed
/// counts alike, and so does each of its rings, as if their number were chosen at random. Fastest when all sets are given at
/// once. The same for any number of threads;
/// without meaning once cancelled. Preconditions: the mesh has a triangle and an area, no set is empty.
std::vector<Discrepancy> ring_discrepancy(const TriangleMesh& mesh, std::span<const std::vector<std::uint32_t>> sets,
                                          const RingDiscrepancyOptions& options = {}, const ExecutionContext& context = {});

}  // namespace curvecast
