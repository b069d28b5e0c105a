#include "server/session/session_surface.h"

#include <utility>

namespace curvecast::server {

SessionSurface::SessionSurface(std::shared_ptr<const FlattenedMesh> flattened) {
  if (flattened != nullptr)
    load_ = [flattened = std::move(flattened)](const ExecutionContext& context) { return curve_base(flattened, context); };
}

void SessionSurface::set_base(std::shared_ptr<const CurveBase> base) {
  bytes_ = base->is_in_memory() ? base->byte_size() : 0;
  base_ = base;
  leaves_ = nullptr;
  load_ = nullptr;
  const MutexLock lock(loaded_mutex_);
  loaded_ = std::move(base);
}

absl::Status SessionSurface::status() const {
  std::shared_ptr<const CurveBase> base;
  {
    const MutexLock lock(loaded_mutex_);
    base = loaded_;
  }
  return base != nullptr ? base->status() : absl::OkStatus();
}

absl::Status SessionSurface::load_base(const ExecutionContext& context) {
  if (base_ != nullptr) return absl::OkStatus();
  if (!load_) return absl::UnavailableError("its surface is not at hand");
  absl::StatusOr<std::shared_ptr<const CurveBase>> base = load_(context);
  if (!base.ok()) return base.status();
  set_base(*std::move(base));
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const CurveBase>> SessionSurface::base(const ExecutionContext& context) {
  const MutexLock lock(mutex_);
  if (absl::Status status = load_base(context); !status.ok()) return status;
  return base_;
}

absl::StatusOr<std::shared_ptr<const LeafSurface>> SessionSurface::leaves(const std::shared_ptr<const SurfaceCurve>& curve,
                                                                          const ExecutionContext& context) {
  const MutexLock lock(mutex_);
  if (absl::Status status = load_base(context); !status.ok()) return status;
  if (base_->charts.size() + 1 != curve->disc_begin.size() || base_->data.scalars.size() != curve->scalars.size()) {
    return absl::DataLossError("its surface is another curve's");
  }
  if (leaves_ == nullptr || leaves_->shared_curve() != curve) leaves_ = std::make_shared<const LeafSurface>(base_, curve);
  return leaves_;
}

void SessionSurface::move_to(std::shared_ptr<const CurveBase> base) {
  const MutexLock lock(mutex_);
  set_base(std::move(base));
}

}  // namespace curvecast::server
