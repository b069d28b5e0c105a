// Samples the point set of a session that one request asks for.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>

#include "core/base/execution_context.h"
#include "core/base/memory_claim.h"
#include "core/base/work_limit.h"
#include "core/density/fixed_density_cache.h"
#include "server/convert/convert_points.h"
#include "server/convert/point_set_request.h"
#include "server/frame/view_lattice.h"
#include "server/frame/workspaces.h"
#include "server/session/rank_jobs.h"
#include "server/session/session.h"

namespace curvecast::server {

/// What the density of one answer may take of all processors together, where none is kept.
inline constexpr WorkLimit::Nanoseconds kMostViewWork = std::chrono::seconds(2);
/// What moving the points of one answer apart may take of all processors together: some 60 million moves.
inline constexpr WorkLimit::Nanoseconds kMostRelaxationWork = std::chrono::seconds(30);

/// Holds what views have in common, so that none makes it anew. Thread-safe.
struct ViewCache {
  FixedDensityCache fixed_densities;
  Workspaces workspaces;

  /// Returns the bytes that are kept and not in use.
  std::size_t byte_size() const { return fixed_densities.byte_size() + workspaces.byte_size(); }
  /// Frees what is kept, which is made again when it is needed.
  void clear() {
    fixed_densities.clear();
    workspaces.clear();
  }
};

/// Asks for what an answer lacked. Each function returns whether that is being made, so that a better answer can follow; an empty
/// function stands for one that returns false.
struct ImprovementRequests {
  /// Asks for a finer revision than `curve`, which is too coarse for so many points.
  std::function<bool(const SurfaceCurve& curve, std::uint64_t points)> finer_curve;
  /// Asks for the ranked candidates that a view lacks.
  std::function<bool(RankDemand demand)> more_ranks;
};

/// The points of one request.
struct Sampled {
  std::shared_ptr<const SurfaceCurve> curve;  // the revision that was sampled
  Workspaces::Lease workspace;                // holds the points
  bool is_coarse = false;                     // the curve is too coarse for so many points
  PointSetStatistics statistics;
  bool is_ranked = false;  // the progressive sampler placed them
  bool lacks_ranks = false;
  RankDemand demand;  // where ranks lack
  LatticeNeed need;
  ViewLattice lattice;                         // on which the points are sent: need.best, unless whoever packs them has a reason
  std::shared_ptr<const LeafSurface> surface;  // below the curve; null unless attributes are wanted of it

  PointSet& points() { return is_ranked ? workspace->ranked.points : workspace->equalised.points; }
  const PointSet& points() const { return is_ranked ? workspace->ranked.points : workspace->equalised.points; }
};

/// Samples one revision of a session's curve, for one request. Keeps the addresses of all that open() is given. Not thread-safe.
class SessionSampler {
 public:
  /// How long a request waits for ranked candidates: until there are all that it needs, or for the first ones only.
  enum class Wait { kForAll, kForFirst };

  /// Errors as of curvecast::resample; Cancelled, also by the functions below, once `context` is. DeadlineExceeded: the density
  /// takes more than the context's limit or, where it has none, kMostViewWork.
  static absl::StatusOr<SessionSampler> open(const Session& session, const PointSetRequest& request, ViewCache& cache, Wait wait,
                                             const ExecutionContext& context = {});

  const SurfaceCurve& curve() const { return *curve_; }
  /// Returns the number of points that the request's budget allows, unless that is one in bytes.
  absl::StatusOr<std::uint64_t> points() const;
  /// Samples so many points; fewer where ranked candidates lack.
  absl::StatusOr<Sampled> sample(std::uint64_t points);

  /// Whether the progressive sampler places the points.
  bool is_ranked() const { return ranks_ != nullptr; }
  /// Selects ranked points without listing them: workspace->ranked.selection has them. `whole`: how many the view wants in the
  /// end; candidates that lack are asked for so many. Precondition: is_ranked().
  absl::StatusOr<Sampled> select(std::uint64_t points, std::uint64_t whole);
  /// Expects the scale of an earlier view, which is likely to be near.
  void expect_scale(double scale) { expected_scale_ = scale; }
  /// Lists the points that select() selected.
  static void list(Sampled& selected, const PointAttributes& attributes);

 private:
  SessionSampler(const Session& session, const PointSetRequest& request, ViewCache& cache, Wait wait,
                 const ExecutionContext& context)
      : session_(&session), request_(&request), cache_(&cache), wait_(wait), cancel_(context.cancel), memory_(context.memory) {}
  /// Moves the points apart as the request says.
  absl::Status relax(Sampled& sampled) const;
  /// Sets sampled.surface where the request's attributes need it.
  absl::Status find_surface(Sampled& sampled) const;
  /// Returns why ranked points are fewer than wanted. What a caller does not wait for counts as being made.
  PointLimit limit_of(const RankSelection& selection, std::uint64_t points, std::uint64_t whole) const;
  /// Cancelled, or OK.
  absl::Status check_cancel() const { return ExecutionContext{.cancel = cancel_}.check(); }

  const Session* session_;
  const PointSetRequest* request_;
  ViewCache* cache_;
  Wait wait_;
  const std::atomic<bool>* cancel_;
  MemorySource* memory_;
  std::shared_ptr<const SurfaceCurve> curve_;
  std::shared_ptr<const RankTree> ranks_;  // null: the equalised sampler
  std::shared_ptr<const FixedDensity> fixed_;
  double expected_scale_ = 0;  // not known
  double fixed_seconds_ = 0;
};

/// Claims the memory that it takes to sample so many points and pack them. Errors as of MemoryClaim::set().
absl::Status claim_points(std::uint64_t points, MemoryClaim& claim);

/// Samples all points that the request's budget allows; waits for ranked candidates to be made. Not for budgets in bytes.
absl::StatusOr<Sampled> sample_points(const Session& session, const PointSetRequest& request, ViewCache& cache,
                                      const ExecutionContext& context);

}  // namespace curvecast::server
