#include "client/bench/disc_leaves.h"

#include <utility>

namespace curvecast::cli::bench {

absl::StatusOr<std::vector<DiscLeaves>> disc_leaves(const FlattenedMesh& flattened, std::uint64_t points,
                                                    const ExecutionContext& context) {
  constexpr std::size_t kMostLeaves = std::size_t{1} << 30;
  const double wanted = PreprocessOptions{}.omega * static_cast<double>(points) / flattened.loaded.info.area;
  std::vector<DiscLeaves> discs;
  for (const Chart& chart : flattened.charts) {
    DiscLeaves& disc = discs.emplace_back();
    disc.triangles = parameter_triangles(chart);
    std::vector<double> demand;
    for (const ParameterTriangle& triangle : disc.triangles) demand.push_back(wanted * triangle.area_ratio);
    absl::StatusOr<QuadtreeLeaves> leaves = build_quadtree(disc.triangles, demand, kMostLeaves, context);
    if (!leaves.ok()) return leaves.status();
    disc.leaves = *std::move(leaves);
  }
  return discs;
}

}  // namespace curvecast::cli::bench
