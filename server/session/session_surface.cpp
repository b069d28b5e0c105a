#include "server/session/session_surface.h"

#include <utility>

namespace curvecast::server {

absl::Status SessionSurface::load_base(const Load& load) {
  if (base_ != nullptr) return absl::OkStatus();
  absl::StatusOr<std::shared_ptr<const FlattenedMesh>> flattened = load();
  if (!flattened.ok()) return flattened.status();
  base_ = curve_base(*std::move(flattened));
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const CurveBase>> SessionSurface::base(const Load& load) {
  const MutexLock lock(mutex_);
  if (absl::Status status = load_base(load); !status.ok()) return status;
  return base_;
}

absl::StatusOr<std::shared_ptr<const LeafSurface>> SessionSurface::leaves(const std::shared_ptr<const SurfaceCurve>& curve,
                                                                          const Load& load) {
  const MutexLock lock(mutex_);
  if (absl::Status status = load_base(load); !status.ok()) return status;
  if (leaves_ == nullptr || leaves_->shared_curve() != curve) leaves_ = std::make_shared<const LeafSurface>(base_, curve);
  return leaves_;
}

}  // namespace curvecast::server
