#include "server/session/rank_jobs.h"

#include <spdlog/logger.h>

#include <string>
#include <utility>

#include "core/base/stopwatch.h"
#include "server/base/status_from_exceptions.h"

namespace curvecast::server {
namespace {

// So often views are answered anew while their candidates are being made, if they would show a good deal more.
constexpr double kSliceSeconds = 0.1;
constexpr double kGoodDeal = 1.25;

/// What several views lack together.
LackingRanks lacking_of(const Demands<RankDemand>& demands, const std::shared_ptr<const RankTree>& tree) {
  LackingRanks all;
  for (const RankDemand& demand : demands) {
    const LackingRanks one = demand(tree);
    all.chunks.insert(all.chunks.end(), one.chunks.begin(), one.chunks.end());
    all.points += one.points;
  }
  return all;
}

/// Grows candidates until nothing lacks or the time has come to show them. Returns whether there are more than before.
absl::StatusOr<bool> grow(const Session& session, const Demands<RankDemand>& demands, const ExecutionContext& context) {
  Stopwatch watch;
  absl::StatusOr<RankedCurve> ranked = session.ranks(context);
  if (!ranked.ok()) return ranked.status();
  LackingRanks lacking = lacking_of(demands, ranked->tree);
  const std::size_t points_before = lacking.points, tree_before = ranked->tree->points();
  double seconds = 0;
  while (!lacking.chunks.empty()) {
    ranked = session.candidates->grow(lacking.chunks, context);
    if (!ranked.ok()) return ranked.status();
    lacking = lacking_of(demands, ranked->tree);
    seconds += watch.lap();
    if (seconds > kSliceSeconds && static_cast<double>(lacking.points) > kGoodDeal * static_cast<double>(points_before)) break;
  }
  if (absl::Status status = session.status(); !status.ok()) return status;
  return ranked->tree->points() != tree_before;
}

}  // namespace

RankJobs::RankJobs(int threads, OnDone on_done, std::shared_ptr<spdlog::logger> log)
    : log_(std::move(log)),
      crew_(threads - 1),
      jobs_({.improve = [this](const Session& session, const Demands<RankDemand>& demands,
                               const std::atomic<bool>& cancel) { return improve(session, demands, cancel); },
             .on_done = [on_done = std::move(on_done)](const Session& session, bool /*is_better*/) { on_done(session); }}) {}

bool RankJobs::request(const std::shared_ptr<const Session>& session, std::uint64_t source, RankDemand demand) {
  return jobs_.request(session, source, std::move(demand));
}

Improvement RankJobs::improve(const Session& session, const Demands<RankDemand>& demands, const std::atomic<bool>& cancel) {
  Stopwatch watch;
  // Threads of oneTBB's would run at the priority of views.
  const ExecutionContext context{
      .cancel = &cancel, .threads = 1, .for_all = [this](std::size_t n, const auto& work) { crew_.for_all(n, work); }};
  const absl::StatusOr<bool> grown = status_from_exceptions([&] { return grow(session, demands, context); });
  if (grown.ok()) {
    log_->info("session {} has more ranked candidates in {:.3f} s", session.id, watch.lap());
  } else if (!cancel) {
    log_->warn("session {} has no more ranked candidates: {}", session.id, std::string(grown.status().message()));
  }
  return {.is_better = grown.ok() && *grown};
}

}  // namespace curvecast::server
