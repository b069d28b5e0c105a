#include "server/session/refiner.h"

#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>
#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "core/base/stopwatch.h"
#include "server/base/status_from_exceptions.h"

namespace curvecast::server {
namespace {

bool is_uniform(const std::vector<DensityTerm>& density) {
  return std::all_of(density.begin(), density.end(),
                     [](const DensityTerm& term) { return std::holds_alternative<UniformTerm>(term); });
}

/// Of the leaves: with its surface they make a curve what it is.
std::uint64_t digest_of(const SurfaceCurve& curve) {
  const std::uint64_t keys = XXH3_64bits(curve.key.data(), curve.key.size() * sizeof(*curve.key.data()));
  return XXH3_64bits_withSeed(curve.level.data(), curve.level.size() * sizeof(*curve.level.data()), keys);
}

}  // namespace

absl::StatusOr<RefinedCurve> refine_session(const Session& session, std::span<const CurveDemand> demands,
                                            std::uint64_t max_vertices, const ExecutionContext& context) {
  const absl::StatusOr<std::shared_ptr<const CurveBase>> base = session.curve_base();
  if (!base.ok()) return base.status();
  const std::shared_ptr<const SurfaceCurve> curve = session.curve();
  RefineOptions options{.omega = session.options.omega, .max_vertices = max_vertices};
  for (const CurveDemand& demand : demands) {
    if (is_uniform(session.options.density) && is_uniform(demand.density.terms)) {
      options.max_points = std::max(options.max_points, demand.points);
    }
  }
  absl::StatusOr<RefinedCurve> refined = refine(**base, *curve, demands, options, context);
  if (absl::Status status = session.status(); !status.ok()) return status;
  if (refined.ok() && refined->curve != nullptr) {
    refined->curve->revision = next_revision_number(session.curve()->revision, digest_of(*refined->curve));
    session.revisions->publish(refined->curve);
  }
  return refined;
}

Refiner::Refiner(std::uint64_t max_vertices, OnDone on_done, Room room, std::shared_ptr<spdlog::logger> log)
    : max_vertices_(max_vertices),
      room_(std::move(room)),
      log_(std::move(log)),
      jobs_({.improve = [this](const Session& session, const Demands<CurveDemand>& demands,
                               const std::atomic<bool>& cancel) { return improve(session, demands, cancel); },
             .on_done = std::move(on_done),
             .mark = [](const Session& session, bool has_job) { session.revisions->set_refining(has_job); }}) {}

bool Refiner::request(const std::shared_ptr<const Session>& session, const SurfaceCurve& curve, std::uint64_t source,
                      CurveDemand demand) {
  if (max_vertices_ == 0) return false;
  // The client missed a finer revision, and will see then whether that is enough.
  if (session->curve()->revision > curve.revision) return true;
  if (session->refinement->is_over) return false;
  // A copy, so that the session may be evicted while its job runs or waits.
  return jobs_.request(std::make_shared<const Session>(*session), source, std::move(demand));
}

void Refiner::forget(const Session& session) {
  session.refinement->is_over = true;
  jobs_.cancel(session);
}

Improvement Refiner::improve(const Session& session, const Demands<CurveDemand>& demands, const std::atomic<bool>& cancel) const {
  Stopwatch watch;
  const absl::StatusOr<RefinedCurve> refined = status_from_exceptions([&] { return refine_once(session, demands, cancel); });
  if (!refined.ok()) {
    if (!cancel && !session.refinement->is_over)
      log_->error("session {} was not refined: {}", session.id, refined.status().ToString());
    session.refinement->is_over = true;
    return {.is_last = true};
  }
  const std::shared_ptr<SurfaceCurve>& curve = refined->curve;
  if (curve != nullptr) {
    log_->info("session {} refined in {:.3f} s: revision {}, {} curve vertices, {} MiB", session.id, watch.lap(), curve->revision,
               curve->size(), curve->byte_size() >> 20);
  }
  const bool is_at_limit = refined->divisor > 1;
  if (is_at_limit) session.refinement->is_over = true;
  return {.is_better = curve != nullptr, .is_last = is_at_limit};
}

absl::StatusOr<RefinedCurve> Refiner::refine_once(const Session& session, const Demands<CurveDemand>& demands,
                                                  const std::atomic<bool>& cancel) const {
  if (session.refinement->is_over) return absl::CancelledError("the session was closed");
  std::vector<CurveDemand> all;
  for (const CurveDemand& demand : demands) all.push_back(demand);
  return refine_session(session, all, affordable_vertices(*session.curve()), {.cancel = &cancel, .threads = 1});
}

std::uint64_t Refiner::affordable_vertices(const SurfaceCurve& curve) const {
  if (curve.size() == 0) return max_vertices_;
  const std::uint64_t bytes = curve.byte_size() / curve.size() + 1;
  return std::min(max_vertices_, room_() / 2 / bytes);
}

}  // namespace curvecast::server
