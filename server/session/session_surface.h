// The surface on which a session's curve lies, loaded when it is first needed.
#pragma once

#include <absl/status/statusor.h>

#include <functional>
#include <memory>

#include "core/base/mutex.h"
#include "core/pipeline/curve_surface.h"

namespace curvecast::server {

/// Thread-safe.
class SessionSurface {
 public:
  using Load = std::function<absl::StatusOr<std::shared_ptr<const FlattenedMesh>>()>;

  /// Returns what refinement starts from. The first call loads it, others wait. Errors are those of `load`.
  absl::StatusOr<std::shared_ptr<const CurveBase>> base(const Load& load) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Returns the surface below the leaves of a curve that lies on it: one of the session's revisions. Errors as of base().
  absl::StatusOr<std::shared_ptr<const LeafSurface>> leaves(const std::shared_ptr<const SurfaceCurve>& curve, const Load& load)
      ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  absl::Status load_base(const Load& load) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  Mutex mutex_;
  std::shared_ptr<const CurveBase> base_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const LeafSurface> leaves_ ABSL_GUARDED_BY(mutex_);  // of the curve that was last asked for
};

}  // namespace curvecast::server
