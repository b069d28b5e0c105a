#include "server/frame/session_sampler.h"

#include "core/base/execution_context.h"
#include "core/base/stopwatch.h"
#include "core/progressive/sample_ranked.h"
#include "core/refine/curve_resolution.h"
#include "core/sample/point_budget.h"

namespace curvecast::server {
namespace {

// Each makes candidates one level deeper where they lack: more there are not.
constexpr int kMaxRounds = kMaxRankLevel - kChunkLevels + 1;

}  // namespace

absl::StatusOr<SessionSampler> SessionSampler::open(const Session& session, const PointSetRequest& request, ViewCache& cache,
                                                    Wait wait, const std::atomic<bool>* cancel) {
  if (absl::Status status = check_density(request.options.density); !status.ok()) return status;
  SessionSampler out(session, request, cache, wait, cancel);
  out.curve_ = session.curve();
  if (request.sampler == Sampler::kProgressive) {
    const absl::StatusOr<RankedCurve> ranked = session.candidates->take(out.curve_, {.cancel = cancel, .threads = 1});
    if (!ranked.ok()) return ranked.status();
    out.curve_ = ranked->curve;
    out.ranks_ = ranked->tree;
  }
  Stopwatch watch;
  absl::StatusOr<std::shared_ptr<const FixedDensity>> fixed =
      cache.fixed_densities.get(out.curve_, request.options.density.terms);
  if (!fixed.ok()) return fixed.status();
  out.fixed_ = *std::move(fixed);
  out.fixed_seconds_ = watch.lap();
  return out;
}

absl::StatusOr<std::uint64_t> SessionSampler::points() const {
  const ResampleOptions& options = request_->options;
  if (request_->pixel_error > 0) return points_for_pixel_error(*curve_, options.density, request_->pixel_error);
  return scaled_points(options.density, curve_->box, options.points);
}

absl::StatusOr<Sampled> SessionSampler::sample(std::uint64_t points) {
  if (is_ranked()) {
    absl::StatusOr<Sampled> selected = select(points);
    if (selected.ok()) list(*selected);
    return selected;
  }
  Sampled out{curve_, cache_->workspaces.lease()};
  out.statistics.curve_vertices = curve_->size();
  ResampleReport report;
  ResampleOptions options = request_->options;
  options.points = points;
  absl::Status status = resample(*curve_, fixed_.get(), options, out.workspace->equalised, &report);
  status.Update(check_cancel());
  if (!status.ok()) return status;
  out.is_coarse = session_->options.omega * report.most_on_vertex > kMaxVertexLoad;
  out.statistics.density_seconds = fixed_seconds_ + report.density_seconds;
  out.statistics.equalise_seconds = report.equalise_seconds;
  return out;
}

absl::StatusOr<Sampled> SessionSampler::select(std::uint64_t points) {
  Sampled out{curve_, cache_->workspaces.lease()};
  out.statistics.curve_vertices = curve_->size();
  out.is_ranked = true;
  const RankSelection& selection = out.workspace->ranked.selection;
  Stopwatch watch;
  for (int round = 0;; ++round) {
    const absl::Status status =
        select_ranked(*curve_, ranks_, fixed_.get(), request_->options.density, points, out.workspace->ranked);
    if (!status.ok()) return status;
    if (selection.lacking.empty() || wait_ == Wait::kForFirst || session_->candidates->is_full() || round == kMaxRounds) break;
    const absl::Status grown = session_->candidates->grow(selection.lacking, {.cancel = cancel_});
    // Without room for more, those that there are have to do.
    if (!grown.ok() && !absl::IsResourceExhausted(grown)) return grown;
    const absl::StatusOr<RankedCurve> ranked = session_->candidates->take(curve_, {});
    if (!ranked.ok()) return ranked.status();
    ranks_ = ranked->tree;
  }
  if (absl::Status status = check_cancel(); !status.ok()) return status;
  if (wait_ == Wait::kForAll && selection.count == 0) return nowhere_to_put_points();
  out.lacks_ranks = !selection.lacking.empty();
  out.statistics.density_seconds = fixed_seconds_;
  out.statistics.equalise_seconds = watch.lap();
  return out;
}

void SessionSampler::list(Sampled& selected) {
  Stopwatch watch;
  list_ranked(*selected.curve, selected.workspace->ranked);
  selected.statistics.equalise_seconds += watch.lap();
}

}  // namespace curvecast::server
