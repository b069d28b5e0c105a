#include "client/bench/points/progressive_points.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/pipeline/curve_surface.h"
#include "core/progressive/sample_ranked.h"

namespace curvecast::cli::bench {
namespace {

ExecutionContext quiet(ExecutionContext context) {
  context.on_progress = nullptr;
  return context;
}

}  // namespace

absl::StatusOr<ProgressivePoints> ProgressivePoints::make(const Preprocessed& made, std::uint64_t points, std::uint64_t seed,
                                                          const ExecutionContext& context) {
  const int level = std::clamp((static_cast<int>(std::bit_width(points - 1)) + 1) / 2, kChunkLevels, kMaxLevelAtOnce);
  absl::StatusOr<std::unique_ptr<RankGrower>> grower =
      RankGrower::make(leaf_surface(made), {.level = level, .seed = seed}, quiet(context));
  if (!grower.ok()) return grower.status();
  ProgressivePoints out;
  out.grower_ = *std::move(grower);
  return out;
}

absl::StatusOr<PointSet> ProgressivePoints::sample(const Density& density, std::uint64_t n, const ExecutionContext& context) {
  const SurfaceCurve& curve = grower_->curve();
  const absl::StatusOr<std::shared_ptr<const FixedDensity>> fixed = make_fixed_density(curve, density.terms);
  if (!fixed.ok()) return fixed.status();
  RankedWorkspace workspace;
  while (true) {
    absl::Status status = select_ranked(curve, grower_->tree(), fixed->get(), density, n, workspace);
    if (!status.ok()) return status;
    if (workspace.selection.lacking.empty()) break;
    status = grower_->grow(workspace.selection.most_lacking(), 8 * kMaxPoints, quiet(context));
    if (!status.ok()) return status;
  }
  list_ranked(curve, workspace, true);
  return std::move(workspace.points);
}

}  // namespace curvecast::cli::bench
