// Point sets of a session, for one request.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/density/fixed_density_cache.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/convert/sample.h"
#include "server/frame/workspaces.h"
#include "server/session/session.h"

namespace curvecast::server {

/// What views have in common, so that none makes it anew. Thread-safe.
struct ViewCache {
  FixedDensityCache fixed_densities;
  Workspaces workspaces;
};

/// Told that an answer is not as good as it could be: whether what it wants is being made, so that a better one follows. Both may
/// be empty.
struct OnShort {
  /// The session's curve, of this revision, is too coarse for so many points.
  std::function<bool(const SurfaceCurve& curve, std::uint64_t points)> finer_curve;
  /// These ranked candidates are lacking.
  std::function<bool(std::span<const ChunkId> lacking)> more_ranks;
};

struct Sampled {
  std::shared_ptr<const SurfaceCurve> curve;  // the one that was sampled
  Workspaces::Lease workspace;                // holds the points
  bool is_short = false;                      // the curve is too coarse
  v1::FrameStatistics statistics;

  const PointSet& points() const { return is_ranked ? workspace->ranked.points : workspace->equalised.points; }
  /// What the ranked candidates lack; never any for the other sampler.
  std::span<const ChunkId> lacking() const {
    return lacks_ranks ? workspace->ranked.selection.lacking : std::span<const ChunkId>();
  }

  bool is_ranked = false;  // made by the progressive sampler
  bool lacks_ranks = false;
};

/// All answers are from one revision of the curve. Keeps the addresses of all that it is given.
class SessionSampler {
 public:
  /// How long a request waits for ranked candidates: until there are all that it needs, or for the first ones only.
  enum class Wait { kForAll, kForFirst };

  /// Errors as of curvecast::resample, and Cancelled once `cancel` is set, also of the others below; it may be null.
  static absl::StatusOr<SessionSampler> open(const Session& session, const Sample& sample, ViewCache& cache, Wait wait,
                                             const std::atomic<bool>* cancel = nullptr);

  const SurfaceCurve& curve() const { return *curve_; }
  /// N for the budgets that do not depend on how points are packed.
  absl::StatusOr<std::uint64_t> points() const;
  /// As many points, but fewer where ranked candidates lack.
  absl::StatusOr<Sampled> sample(std::uint64_t points);

  bool is_ranked() const { return ranks_ != nullptr; }
  /// Ranked points, selected but not listed yet: workspace->ranked.selection has them. Precondition: is_ranked().
  absl::StatusOr<Sampled> select(std::uint64_t points);
  /// Lists what was selected.
  static void list(Sampled& selected);

 private:
  SessionSampler(const Session& session, const Sample& sample, ViewCache& cache, Wait wait, const std::atomic<bool>* cancel)
      : session_(&session), sample_(&sample), cache_(&cache), wait_(wait), cancel_(cancel) {}
  absl::Status wanted() const { return ExecutionContext{.cancel = cancel_}.check(); }

  const Session* session_;
  const Sample* sample_;
  ViewCache* cache_;
  Wait wait_;
  const std::atomic<bool>* cancel_;
  std::shared_ptr<const SurfaceCurve> curve_;
  std::shared_ptr<const RankTree> ranks_;  // null: the equalised sampler
  std::shared_ptr<const FixedDensity> fixed_;
  double fixed_seconds_ = 0;
};

}  // namespace curvecast::server
