#include "core/sample/point_blocks.h"

#include <algorithm>
#include <bit>

namespace curvecast {
namespace {

constexpr std::size_t kLanes = 8;  // boxes of a fan

CURVECAST_WIDE void mark(const PointBlocks::Point& p, float reach_in_spacings, float least, PointBlocks::Scratch& scratch) {
  const float *x0 = scratch.low[0].data(), *y0 = scratch.low[1].data(), *z0 = scratch.low[2].data();
  const float *x1 = scratch.high[0].data(), *y1 = scratch.high[1].data(), *z1 = scratch.high[2].data();
  const float* const spacing = scratch.spacing.data();
  std::int32_t* const is_near = scratch.is_near.data();
  const std::size_t count = scratch.near.size();
  for (std::size_t n = 0; n < count; ++n) {
    const float dx = fast_max(fast_max(x0[n] - p.x, p.x - x1[n]), 0.0F);
    const float dy = fast_max(fast_max(y0[n] - p.y, p.y - y1[n]), 0.0F);
    const float dz = fast_max(fast_max(z0[n] - p.z, p.z - z1[n]), 0.0F);
    const float reach = reach_in_spacings * fast_min(p.spacing, fast_max(least, spacing[n]));
    is_near[n] = dx * dx + dy * dy + dz * dz < reach * reach;
  }
}

/// Columns of boxes.
struct BoxColumns {
  const float *x0, *y0, *z0, *x1, *y1, *z1, *spacing;
};

/// Finds which of kLanes boxes may be nearer to one than `reach_in_spacings` says: bit by bit.
CURVECAST_WIDE std::uint32_t near_boxes(const BoxColumns& boxes, const PointBlocks::Box& around, float reach_in_spacings,
                                        float least) {
  std::int32_t is_near[kLanes];
  for (std::size_t n = 0; n < kLanes; ++n) {
    const float dx = fast_max(fast_max(boxes.x0[n] - around.high[0], around.low[0] - boxes.x1[n]), 0.0F);
    const float dy = fast_max(fast_max(boxes.y0[n] - around.high[1], around.low[1] - boxes.y1[n]), 0.0F);
    const float dz = fast_max(fast_max(boxes.z0[n] - around.high[2], around.low[2] - boxes.z1[n]), 0.0F);
    const float reach = reach_in_spacings * fast_min(around.spacing, fast_max(least, boxes.spacing[n]));
    is_near[n] = dx * dx + dy * dy + dz * dz < reach * reach;
  }
  std::uint32_t bits = 0;
  for (std::size_t n = 0; n < kLanes; ++n) bits |= static_cast<std::uint32_t>(is_near[n]) << n;
  return bits;
}

}  // namespace

PointBlocks::Boxes::Boxes(std::size_t boxes) : count(boxes) {
  const std::size_t filled = (boxes + kFan - 1) / kFan * kFan;
  for (std::vector<float>& column : low) column.resize(filled, kFarAway);
  for (std::vector<float>& column : high) column.resize(filled, -kFarAway);
  spacing.resize(filled);
}

void PointBlocks::Boxes::set(std::size_t b, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis][b] = box.low[static_cast<Eigen::Index>(axis)];
    high[axis][b] = box.high[static_cast<Eigen::Index>(axis)];
  }
  spacing[b] = box.spacing;
}

PointBlocks::PointBlocks(std::size_t points) : size_(points) {
  std::size_t count = (points + kBlock - 1) / kBlock;
  for (std::vector<float>* column : {&x_, &y_, &z_}) column->resize(count * kBlock, kFarAway);
  for (std::vector<float>* column : {&nx_, &ny_, &nz_, &spacing_}) column->resize(count * kBlock, 0.0F);
  boxes_.emplace_back(count);
  while (count > kFan) {
    count = (count + kFan - 1) / kFan;
    boxes_.emplace_back(count);
  }
}

void PointBlocks::set(std::size_t i, const Vec3f& position, const Vec3f& normal, float spacing) {
  x_[i] = position.x(), y_[i] = position.y(), z_[i] = position.z();
  nx_[i] = normal.x(), ny_[i] = normal.y(), nz_[i] = normal.z();
  spacing_[i] = spacing;
}

void PointBlocks::fill_boxes() {
  for (std::size_t b = 0; b < block_count(); ++b) {
    Box box;
    for (std::size_t i = b * kBlock; i < b * kBlock + size_of(b); ++i) box.extend(point(i));
    boxes_[0].set(b, box);
  }
  for (std::size_t level = 1; level < boxes_.size(); ++level) {
    const Boxes& below = boxes_[level - 1];
    for (std::size_t b = 0; b < boxes_[level].count; ++b) {
      Box box;
      for (std::size_t i = b * kFan; i < std::min(below.count, (b + 1) * kFan); ++i) box.extend(below.box(i));
      boxes_[level].set(b, box);
    }
  }
}

void PointBlocks::move(std::size_t i, const Vec3f& position, const Vec3f& normal) {
  set(i, position, normal, spacing_[i]);
  std::size_t b = i / kBlock;
  for (Boxes& level : boxes_) {
    Box box = level.box(b);
    box.extend(point(i));
    level.set(b, box);
    b /= kFan;
  }
}

void PointBlocks::list_near(const Box& around, float reach, Scratch& scratch, float least) const {
  scratch.near.clear();
  add_near(boxes_.size() - 1, 0, around, reach, least, scratch.near);
  const std::size_t count = scratch.near.size();
  const Boxes& blocks = boxes_[0];
  const auto gather = [&](const std::vector<float>& from, std::vector<float>& to) {
    to.resize(count);
    for (std::size_t n = 0; n < count; ++n) to[n] = from[scratch.near[n]];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    gather(blocks.low[axis], scratch.low[axis]);
    gather(blocks.high[axis], scratch.high[axis]);
  }
  gather(blocks.spacing, scratch.spacing);
  scratch.is_near.resize(count);
}

void PointBlocks::mark_near(const Point& point, float reach, Scratch& scratch, float least) {
  mark(point, reach, least, scratch);
}

/// Lists the blocks in a fan of boxes of a level.
void PointBlocks::add_near(std::size_t level, std::size_t fan, const Box& around, float reach, float least,
                           std::vector<std::uint32_t>& near) const {
  const std::size_t first = fan * kFan;
  const Boxes& boxes = boxes_[level];
  if (boxes.count == 0) return;
  const BoxColumns columns{&boxes.low[0][first],  &boxes.low[1][first],  &boxes.low[2][first], &boxes.high[0][first],
                           &boxes.high[1][first], &boxes.high[2][first], &boxes.spacing[first]};
  for (std::uint32_t left = near_boxes(columns, around, reach, least); left != 0; left &= left - 1) {
    const std::size_t b = first + static_cast<std::size_t>(std::countr_zero(left));
    if (level == 0) {
      near.push_back(static_cast<std::uint32_t>(b));
    } else {
      add_near(level - 1, b, around, reach, least, near);
    }
  }
}

}  // namespace curvecast
