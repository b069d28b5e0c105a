#include "server/frame/session_sampler.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <utility>

#include "core/base/execution_context.h"
#include "core/base/stopwatch.h"
#include "core/progressive/sample_ranked.h"
#include "core/refine/curve_resolution.h"
#include "core/sample/move_apart.h"
#include "core/sample/point_budget.h"
#include "core/sample/spread_in_leaves.h"

namespace curvecast::server {
namespace {

/// Says what a view lacks of whatever tree there is later.
RankDemand demand_of(std::shared_ptr<const SurfaceCurve> curve, std::shared_ptr<const FixedDensity> fixed, const Density& density,
                     std::uint64_t points, double expected_scale) {
  struct Selecting {
    RankSelector selector;
    RankSelection selection;
    double expected_scale = 0;
  };
  auto memory = std::make_shared<Selecting>();
  memory->expected_scale = expected_scale;
  return [curve = std::move(curve), fixed = std::move(fixed), density, points,
          memory = std::move(memory)](const std::shared_ptr<const RankTree>& tree) {
    RankSelection& selection = memory->selection;
    memory->selector.select(tree, fixed.get(), ViewFactor(*curve, density), points, selection, memory->expected_scale);
    memory->expected_scale = selection.similar_scale();
    selection.tree.reset();
    selection.parts.clear();
    const std::span<const ChunkId> next = selection.most_lacking();
    return LackingRanks{{next.begin(), next.end()}, selection.count};
  };
}

}  // namespace

absl::StatusOr<SessionSampler> SessionSampler::open(const Session& session, const PointSetRequest& request, ViewCache& cache,
                                                    Wait wait, const ExecutionContext& context) {
  if (absl::Status status = check_density(request.options.density); !status.ok()) return status;
  SessionSampler out(session, request, cache, wait, context);
  out.curve_ = session.curve();
  if (request.sampler == Sampler::kProgressive) {
    const absl::StatusOr<RankedCurve> ranked = session.ranks({.cancel = context.cancel, .threads = 1});
    if (!ranked.ok()) return ranked.status();
    out.curve_ = ranked->curve;
    out.ranks_ = ranked->tree;
  }
  // Ranked points know a picture's detail themselves; only the number of points for an error in pixels takes it from the curve.
  const bool is_known = out.is_ranked() && ViewFactor(*out.curve_, request.options.density).is_fixed_by_detail();
  if (is_known && !(request.pixel_error > 0)) return out;
  Stopwatch watch;
  WorkLimit limit(kMostViewWork);
  absl::StatusOr<std::shared_ptr<const FixedDensity>> fixed =
      cache.fixed_densities.get(out.curve_, request.options.density.terms,
                                {.cancel = context.cancel, .limit = context.limit != nullptr ? context.limit : &limit});
  if (!fixed.ok()) return fixed.status();
  out.fixed_ = *std::move(fixed);
  out.fixed_seconds_ = watch.lap();
  return out;
}

absl::StatusOr<std::uint64_t> SessionSampler::points() const {
  const ResampleOptions& options = request_->options;
  if (request_->pixel_error > 0) return points_for_pixel_error(*curve_, fixed_.get(), options.density, request_->pixel_error);
  return scaled_points(options.density, curve_->box, options.points);
}

absl::StatusOr<Sampled> SessionSampler::sample(std::uint64_t points) {
  if (is_ranked()) {
    absl::StatusOr<Sampled> selected = select(points, points);
    if (selected.ok()) list(*selected, request_->attributes);
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
  out.statistics.wanted_points = points;
  PointSet& placed = out.points();
  if (request_->attributes.need_places() || request_->relaxation_rounds > 0) find_places(*curve_, placed);
  if (absl::Status found = find_surface(out); !found.ok()) return found;
  if (shares_vertices(placed)) {
    const absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves = session_->leaf_surface(curve_);
    if (!leaves.ok()) return leaves.status();
    spread_in_leaves(**leaves, placed);
    if (absl::Status damaged = (*leaves)->status(); !damaged.ok()) return damaged;
  }
  if (absl::Status moved = relax(out); !moved.ok()) return moved;
  out.need = lattice_need(*request_, curve_->box, placed);
  out.lattice = out.need.best;
  return out;
}

absl::Status SessionSampler::relax(Sampled& sampled) const {
  if (request_->relaxation_rounds == 0) return absl::OkStatus();
  Stopwatch watch;
  WorkLimit limit(kMostRelaxationWork);
  const ExecutionContext context{.cancel = cancel_, .limit = &limit, .memory = memory_};
  const absl::StatusOr<std::shared_ptr<const CurveBase>> base = session_->surface->base(context);
  if (!base.ok()) return base.status();
  absl::Status status = move_apart(**base, request_->relaxation_rounds, sampled.points(), context);
  sampled.statistics.equalise_seconds += watch.lap();
  return status;
}

absl::StatusOr<Sampled> SessionSampler::select(std::uint64_t points, std::uint64_t whole) {
  Sampled out{curve_, cache_->workspaces.lease()};
  out.statistics.curve_vertices = curve_->size();
  out.is_ranked = true;
  const Density& density = request_->options.density;
  const RankSelection& selection = out.workspace->ranked.selection;
  Stopwatch watch;
  for (;;) {
    const absl::Status status =
        select_ranked(*curve_, ranks_, fixed_.get(), density, points, out.workspace->ranked, expected_scale_);
    if (!status.ok()) return status;
    if (selection.lacking.empty() || wait_ == Wait::kForFirst) break;
    const absl::StatusOr<RankedCurve> grown = session_->candidates->grow(selection.most_lacking(), {.cancel = cancel_});
    if (!grown.ok()) return grown.status();
    ranks_ = grown->tree;
  }
  if (absl::Status status = check_cancel(); !status.ok()) return status;
  if (wait_ == Wait::kForAll && selection.count == 0) return nowhere_to_put_points();
  out.lacks_ranks = !selection.lacking.empty();
  if (out.lacks_ranks) {
    const double of_whole = selection.similar_scale() * static_cast<double>(whole) / static_cast<double>(points);
    out.demand = demand_of(curve_, fixed_, density, whole, of_whole);
  }
  out.statistics.wanted_points = whole;
  out.statistics.limit = limit_of(selection, points, whole);
  out.need = lattice_need(*request_, *curve_, selection);
  out.lattice = out.need.best;
  if (absl::Status found = find_surface(out); !found.ok()) return found;
  out.statistics.density_seconds = fixed_seconds_;
  out.statistics.equalise_seconds = watch.lap();
  return out;
}

absl::Status SessionSampler::find_surface(Sampled& sampled) const {
  // Of points that have moved, all is asked of the surface.
  const bool need_curvatures = request_->attributes.curvatures && request_->relaxation_rounds > 0;
  if (!request_->attributes.need_surface() && !need_curvatures) return absl::OkStatus();
  absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves = session_->leaf_surface(curve_, {.cancel = cancel_});
  if (!leaves.ok()) return leaves.status();
  sampled.surface = *std::move(leaves);
  return absl::OkStatus();
}

PointLimit SessionSampler::limit_of(const RankSelection& selection, std::uint64_t points, std::uint64_t whole) const {
  if (selection.count >= whole) return PointLimit::kNone;
  if (selection.count >= points) return PointLimit::kComing;
  if (selection.lacking.empty()) return PointLimit::kDensity;
  return wait_ == Wait::kForFirst ? PointLimit::kComing : PointLimit::kServer;
}

void SessionSampler::list(Sampled& selected, const PointAttributes& attributes) {
  Stopwatch watch;
  list_ranked(*selected.curve, selected.workspace->ranked, attributes.need_places());
  selected.statistics.equalise_seconds += watch.lap();
}

absl::Status claim_points(std::uint64_t points, MemoryClaim& claim) {
  constexpr std::uint64_t kPerPoint = 160;
  const std::uint64_t bytes = kPerPoint * std::min(points, kMaxPoints);
  return claim.set(bytes,
                   absl::StrFormat("a set of %d points takes %s of memory", points, describe_bytes(static_cast<double>(bytes))));
}

absl::StatusOr<Sampled> sample_points(const Session& session, const PointSetRequest& request, ViewCache& cache,
                                      const ExecutionContext& context) {
  absl::StatusOr<SessionSampler> sampler = SessionSampler::open(session, request, cache, SessionSampler::Wait::kForAll, context);
  if (!sampler.ok()) return sampler.status();
  const absl::StatusOr<std::uint64_t> points = sampler->points();
  if (!points.ok()) return points.status();
  return sampler->sample(*points);
}

}  // namespace curvecast::server
