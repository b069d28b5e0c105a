#include "core/sample/repulsion.h"

#include <algorithm>
#include <cmath>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr float kFarAway = 1e18F;  // its square is finite still
constexpr float kTiny = 1e-30F;

/// Some points that follow one another.
struct Columns {
  const float *x, *y, *z, *nx, *ny, *nz, *spacing;
};

struct Point {
  float x, y, z, nx, ny, nz, spacing;
};

/// Sums what the points of a block do to one.
struct Push {
  float x[Repulsion::kBlock] = {}, y[Repulsion::kBlock] = {}, z[Repulsion::kBlock] = {};
};

/// How much a point is pushed by another one whose normal is at an angle of such a cosine: 1 up to 90 degrees, 0 from 120 on.
[[gnu::always_inline]] inline float alike(float cosine) { return fast_min(fast_max(1 + 2 * cosine, 0.0F), 1.0F); }

CURVECAST_WIDE void add_block(const Columns& others, const Point& p, Push& push) {
  for (std::size_t k = 0; k < Repulsion::kBlock; ++k) {
    const float dx = p.x - others.x[k], dy = p.y - others.y[k], dz = p.z - others.z[k];
    const float d = std::sqrt(dx * dx + dy * dy + dz * dz + kTiny);
    const float reach = 2 * fast_min(p.spacing, others.spacing[k]);
    const float cosine = p.nx * others.nx[k] + p.ny * others.ny[k] + p.nz * others.nz[k];
    const float near = fast_max(reach - d, 0.0F) / (reach + kTiny);
    const float force = alike(cosine) * near * near / d;
    push.x[k] += force * dx;
    push.y[k] += force * dy;
    push.z[k] += force * dz;
  }
}

/// Marks the boxes in which a point may be near enough to push p.
CURVECAST_WIDE void mark_near(Repulsion::Scratch& scratch, const Point& p) {
  const float *x0 = scratch.low[0].data(), *y0 = scratch.low[1].data(), *z0 = scratch.low[2].data();
  const float *x1 = scratch.high[0].data(), *y1 = scratch.high[1].data(), *z1 = scratch.high[2].data();
  const float* const spacing = scratch.spacing.data();
  std::int32_t* const is_near = scratch.is_near.data();
  const std::size_t count = scratch.near.size();
  for (std::size_t n = 0; n < count; ++n) {
    const float dx = fast_max(fast_max(x0[n] - p.x, p.x - x1[n]), 0.0F);
    const float dy = fast_max(fast_max(y0[n] - p.y, p.y - y1[n]), 0.0F);
    const float dz = fast_max(fast_max(z0[n] - p.z, p.z - z1[n]), 0.0F);
    const float reach = 2 * fast_min(p.spacing, spacing[n]);
    is_near[n] = dx * dx + dy * dy + dz * dz < reach * reach;
  }
}

float sum_of(const float* lanes) {
  float sum = 0;
  for (std::size_t k = 0; k < Repulsion::kBlock; ++k) sum += lanes[k];
  return sum;
}

}  // namespace

Repulsion::Repulsion(std::size_t points) : size_(points) {
  const std::size_t blocks = (points + kBlock - 1) / kBlock;
  for (std::vector<float>* column : {&x_, &y_, &z_}) column->resize(blocks * kBlock, kFarAway);
  for (std::vector<float>* column : {&nx_, &ny_, &nz_, &spacing_}) column->resize(blocks * kBlock, 0.0F);
  std::size_t count = blocks;
  boxes_.emplace_back(count);
  while (count > kFan) {
    count = (count + kFan - 1) / kFan;
    boxes_.emplace_back(count);
  }
}

void Repulsion::set(std::size_t i, const Vec3f& position, const Vec3f& normal, float spacing) {
  x_[i] = position.x(), y_[i] = position.y(), z_[i] = position.z();
  nx_[i] = normal.x(), ny_[i] = normal.y(), nz_[i] = normal.z();
  spacing_[i] = spacing;
}

void Repulsion::fill_boxes() {
  for (std::size_t b = 0; b < boxes_[0].size(); ++b) {
    Box box{Vec3f::Constant(kFarAway), Vec3f::Constant(-kFarAway), 0};
    for (std::size_t i = b * kBlock; i < std::min(size_, (b + 1) * kBlock); ++i) {
      const Vec3f p(x_[i], y_[i], z_[i]);
      box = {box.low.cwiseMin(p), box.high.cwiseMax(p), std::max(box.spacing, spacing_[i])};
    }
    boxes_[0][b] = box;
  }
  for (std::size_t level = 1; level < boxes_.size(); ++level) {
    const std::vector<Box>& below = boxes_[level - 1];
    for (std::size_t b = 0; b < boxes_[level].size(); ++b) {
      Box box = below[b * kFan];
      for (std::size_t i = b * kFan + 1; i < std::min(below.size(), (b + 1) * kFan); ++i) {
        box = {box.low.cwiseMin(below[i].low), box.high.cwiseMax(below[i].high), std::max(box.spacing, below[i].spacing)};
      }
      boxes_[level][b] = box;
    }
  }
}

void Repulsion::move(std::size_t i, const Vec3f& position, const Vec3f& normal) {
  set(i, position, normal, spacing_[i]);
  std::size_t b = i / kBlock;
  for (std::vector<Box>& level : boxes_) {
    level[b].low = level[b].low.cwiseMin(position);
    level[b].high = level[b].high.cwiseMax(position);
    b /= kFan;
  }
}

Repulsion::Nearest Repulsion::nearest(std::size_t i, const Vec3f& position, const Vec3f& normal, Scratch& scratch) const {
  list_near({position, position, spacing_[i]}, scratch.near);
  Nearest nearest;
  for (const std::uint32_t b : scratch.near) {
    for (std::size_t j = b * kBlock; j < std::min(size_, (b + 1) * kBlock); ++j) {
      if (j == i) continue;
      const float distance = (position - Vec3f(x_[j], y_[j], z_[j])).norm() / std::min(spacing_[i], spacing_[j]);
      if (distance >= nearest.on_side) continue;
      nearest.at_all = std::min(nearest.at_all, distance);
      if (alike(normal.dot(Vec3f(nx_[j], ny_[j], nz_[j]))) > 0) nearest.on_side = distance;
    }
  }
  return nearest;
}

void Repulsion::list_near(const Box& around, std::vector<std::uint32_t>& near) const {
  near.clear();
  const std::size_t top = boxes_.size() - 1;
  for (std::size_t b = 0; b < boxes_[top].size(); ++b) add_near(top, b, around, near);
}

/// Lists the blocks in a box whose points may push those in another one.
void Repulsion::add_near(std::size_t level, std::size_t b, const Box& around, std::vector<std::uint32_t>& near) const {
  const Box& box = boxes_[level][b];
  const Vec3f gap = (box.low - around.high).cwiseMax(around.low - box.high).cwiseMax(0.0F);
  const float reach = 2 * std::min(box.spacing, around.spacing);
  if (gap.squaredNorm() >= reach * reach) return;
  if (level == 0) {
    near.push_back(static_cast<std::uint32_t>(b));
    return;
  }
  const std::size_t end = std::min(boxes_[level - 1].size(), (b + 1) * kFan);
  for (std::size_t i = b * kFan; i < end; ++i) add_near(level - 1, i, around, near);
}

std::array<Vec3f, Repulsion::kBlock> Repulsion::find(std::size_t block, Scratch& scratch) const {
  list_near(boxes_[0][block], scratch.near);
  const std::size_t count = scratch.near.size();
  for (std::size_t axis = 0; axis < 3; ++axis) scratch.low[axis].resize(count), scratch.high[axis].resize(count);
  scratch.spacing.resize(count);
  scratch.is_near.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    const Box& box = boxes_[0][scratch.near[n]];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scratch.low[axis][n] = box.low[static_cast<Eigen::Index>(axis)];
      scratch.high[axis][n] = box.high[static_cast<Eigen::Index>(axis)];
    }
    scratch.spacing[n] = box.spacing;
  }
  std::array<Vec3f, kBlock> pushes;
  pushes.fill(Vec3f::Zero());
  const std::size_t begin = block * kBlock, end = std::min(size_, begin + kBlock);
  for (std::size_t i = begin; i < end; ++i) {
    const Point p{x_[i], y_[i], z_[i], nx_[i], ny_[i], nz_[i], spacing_[i]};
    mark_near(scratch, p);
    Push push;
    for (std::size_t n = 0; n < count; ++n) {
      if (scratch.is_near[n] == 0) continue;
      const std::size_t o = scratch.near[n] * kBlock;
      add_block({&x_[o], &y_[o], &z_[o], &nx_[o], &ny_[o], &nz_[o], &spacing_[o]}, p, push);
    }
    pushes[i - begin] = {sum_of(push.x), sum_of(push.y), sum_of(push.z)};
  }
  return pushes;
}

}  // namespace curvecast
