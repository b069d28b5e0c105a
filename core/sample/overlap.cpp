#include "core/sample/overlap.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = PointBlocks::kBlock;
constexpr float kTiny = 1e-30F;
constexpr float kRoom = 1.02F;  // they go farther apart by so much: so that what pushes them back has no effect at once
constexpr float kRate = 0.5F;   // the other one of the two goes the other half
constexpr float kReach = kRoom * kApart;

/// What the points of a block do to one.
struct Steps {
  float x[kBlock] = {}, y[kBlock] = {}, z[kBlock] = {};  // of those in each place of their blocks
  float is_near[kBlock];                                 // above 0 where it is too near; of the last block alone

  Vec3f total() const {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t k = 0; k < kBlock; ++k) sum += Vec3f(x[k], y[k], z[k]);
    return sum;
  }
};

CURVECAST_WIDE void add_block(const PointBlocks::Columns& others, const PointBlocks::Point& p, float apart_behind, Steps& steps) {
  for (std::size_t k = 0; k < kBlock; ++k) {
    const float dx = p.x - others.x[k], dy = p.y - others.y[k], dz = p.z - others.z[k];
    const float cosine = p.nx * others.nx[k] + p.ny * others.ny[k] + p.nz * others.nz[k];
    const float apart = apart_behind + (kApart - apart_behind) * PointBlocks::alike(cosine);
    const float least = apart * fast_min(p.spacing, others.spacing[k]);
    const float wanted = kRoom * least;
    // Only ways within the point's own plane help: what is behind it comes no farther away than by those.
    const float height = dx * p.nx + dy * p.ny + dz * p.nz;
    const float ax = dx - height * p.nx, ay = dy - height * p.ny, az = dz - height * p.nz;
    const float along = std::sqrt(ax * ax + ay * ay + az * az + kTiny);
    const float far = std::sqrt(fast_max(wanted * wanted - height * height, 0.0F));
    const float step = kRate * fast_max(far - along, 0.0F) / along;
    steps.x[k] += step * ax;
    steps.y[k] += step * ay;
    steps.z[k] += step * az;
    const float square = dx * dx + dy * dy + dz * dz;
    steps.is_near[k] = square > 0 ? least * least - square : 0;  // not the point itself
  }
}

/// Whether any of them may be within kReach of the point, whatever ways they face.
CURVECAST_WIDE bool may_be_near(const PointBlocks::Columns& others, const PointBlocks::Point& p) {
  std::int32_t is_near = 0;
  for (std::size_t k = 0; k < kBlock; ++k) {
    const float dx = p.x - others.x[k], dy = p.y - others.y[k], dz = p.z - others.z[k];
    const float most = kReach * fast_min(p.spacing, others.spacing[k]);
    is_near |= dx * dx + dy * dy + dz * dz < most * most;
  }
  return is_near != 0;
}

/// Around those of some points that are awake; without a spacing where none is.
PointBlocks::Box box_of(const PointBlocks& points, std::size_t begin, std::size_t end,
                        const std::vector<std::uint8_t>& is_awake) {
  PointBlocks::Box box;
  for (std::size_t i = begin; i < end; ++i) {
    if (is_awake[i] != 0) box.extend(points.point(i));
  }
  return box;
}

/// The same from any thread, in any order.
void wake(std::vector<std::uint8_t>& wakes, std::size_t i) { std::atomic_ref(wakes[i]).store(1, std::memory_order_relaxed); }

}  // namespace

Overlap find_overlap(const PointBlocks& points, std::size_t block, float apart_behind, const std::vector<std::uint8_t>& is_awake,
                     std::vector<std::uint8_t>& wakes, PointBlocks::Scratch& scratch) {
  Overlap overlap;
  overlap.steps.fill(Vec3f::Zero());
  const std::size_t begin = block * kBlock;
  const PointBlocks::Box around = box_of(points, begin, begin + points.size_of(block), is_awake);
  if (!(around.spacing > 0)) return overlap;
  points.list_near(around, kReach, scratch);
  for (std::size_t k = 0; k < points.size_of(block); ++k) {
    if (is_awake[begin + k] == 0) continue;
    const PointBlocks::Point p = points.point(begin + k);
    Steps steps;
    for (const std::uint32_t near : scratch.near) {
      const PointBlocks::Columns others = points.columns(near);
      if (!may_be_near(others, p)) continue;
      add_block(others, p, apart_behind, steps);
      for (std::size_t j = 0; j < kBlock; ++j) {
        if (!(steps.is_near[j] > 0)) continue;
        overlap.is_found[k] = true;
        wake(wakes, near * kBlock + j);
      }
    }
    if (!overlap.is_found[k]) continue;
    wake(wakes, begin + k);
    overlap.steps[k] = steps.total();
  }
  return overlap;
}

std::size_t count_too_near_behind(const PointBlocks& points, std::size_t block, PointBlocks::Scratch& scratch) {
  points.list_near(points.box(block), kApart, scratch);
  const auto is_too_near_behind = [&](const PointBlocks::Point& p, std::size_t j) {
    const PointBlocks::Point q = points.point(j);
    const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, least = kApart * fast_min(p.spacing, q.spacing);
    return dx * dx + dy * dy + dz * dz < least * least && PointBlocks::alike(p.nx * q.nx + p.ny * q.ny + p.nz * q.nz) == 0;
  };
  std::size_t count = 0;
  for (std::size_t k = 0; k < points.size_of(block); ++k) {
    const PointBlocks::Point p = points.point(block * kBlock + k);
    count += std::any_of(scratch.near.begin(), scratch.near.end(), [&](std::uint32_t b) {
      for (std::size_t j = b * kBlock; j < b * kBlock + points.size_of(b); ++j) {
        if (is_too_near_behind(p, j)) return true;
      }
      return false;
    });
  }
  return count;
}

}  // namespace curvecast
