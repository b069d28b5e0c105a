#include "core/sample/repulsion.h"

#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr float kTiny = 1e-30F;

/// Adds what the points of a block do to one.
CURVECAST_WIDE void add_block(const PointBlocks::Columns& others, const PointBlocks::Point& p, PointBlocks::Sum& push) {
  for (std::size_t k = 0; k < PointBlocks::kBlock; ++k) {
    const float dx = p.x - others.x[k], dy = p.y - others.y[k], dz = p.z - others.z[k];
    const float d = std::sqrt(dx * dx + dy * dy + dz * dz + kTiny);
    const float reach = kRepulsionReach * fast_min(p.spacing, others.spacing[k]);
    const float cosine = p.nx * others.nx[k] + p.ny * others.ny[k] + p.nz * others.nz[k];
    const float near = fast_max(reach - d, 0.0F) / (reach + kTiny);
    const float force = PointBlocks::alike(cosine) * near * near / d;
    push.x[k] += force * dx;
    push.y[k] += force * dy;
    push.z[k] += force * dz;
  }
}

}  // namespace

std::array<Vec3f, PointBlocks::kBlock> repulsion(const PointBlocks& points, std::size_t block, PointBlocks::Scratch& scratch) {
  points.list_near(points.box(block), kRepulsionReach, scratch);
  std::array<Vec3f, PointBlocks::kBlock> pushes;
  pushes.fill(Vec3f::Zero());
  for (std::size_t k = 0; k < points.size_of(block); ++k) {
    const PointBlocks::Point p = points.point(block * PointBlocks::kBlock + k);
    PointBlocks::Sum push;
    PointBlocks::mark_near(p, kRepulsionReach, scratch);
    for (std::size_t n = 0; n < scratch.near.size(); ++n) {
      if (scratch.is_near[n] != 0) add_block(points.columns(scratch.near[n]), p, push);
    }
    pushes[k] = push.total();
  }
  return pushes;
}

}  // namespace curvecast
