#include "core/progressive/stratum_bounds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/curve/curve_blocks.h"
#include "core/curve/leaf_frame.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 512;  // blocks
constexpr float kSlack = 1.0001f;    // for rounding
constexpr std::size_t kSpread = 64;  // points that stand for a stratum within few leaves
constexpr float kBeyond = 1.3f;      // by which points of a stratum may lie farther out than those that stand for it

/// Returns the distance from a leaf's vertex to its farthest corner.
float extent(const LeafFrame& frame) { return 0.5f * (frame.along_x.norm() + frame.along_y.norm()); }

}  // namespace

StratumBounds::StratumBounds(const CurveStrata& strata)
    : strata_(&strata), picture_detail_(strata.curve()), extent_(block_count(strata.curve().size())), detail_(extent_.size()) {
  const std::size_t vertices = strata.curve().size();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, extent_.size(), kGrain), [&](const auto& range) {
    LeafFrames frames(strata.curve());
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      const std::size_t end = std::min((b + 1) * kBlockSize, vertices);
      for (std::size_t l = b * kBlockSize; l < end; ++l) {
        extent_[b] = std::max(extent_[b], extent(frames.of(l)));
        detail_[b] = std::max(detail_[b], picture_detail_.at(l));
      }
    }
  });
}

float StratumBounds::most_detail(std::size_t first_vertex, std::size_t last_vertex) const {
  const auto first = detail_.begin() + static_cast<std::ptrdiff_t>(first_vertex / kBlockSize);
  return *std::max_element(first, detail_.begin() + static_cast<std::ptrdiff_t>(last_vertex / kBlockSize) + 1);
}

StratumBound StratumBounds::of(int level, std::uint64_t stratum) const {
  if (strata_->is_within_leaves(level, stratum)) return within_leaves(level, stratum);
  const SurfaceCurve& curve = strata_->curve();
  StratumBound bound;
  bound.first_vertex = strata_->vertex_at(std::ldexp(static_cast<double>(stratum), -2 * level));
  bound.last_vertex = strata_->vertex_at(std::ldexp(static_cast<double>(stratum + 1), -2 * level));
  bound.detail = most_detail(bound.first_vertex, bound.last_vertex);
  // Few vertices are looked at one by one, many by their blocks.
  const bool is_short = bound.last_vertex - bound.first_vertex < 4 * kBlockSize;
  const std::size_t step = is_short ? 1 : kBlockSize;
  const std::size_t begin = bound.first_vertex / step, end = bound.last_vertex / step + 1;
  const CurveBlocks& blocks = curve.blocks;
  const auto position = [&](std::size_t i) {
    return is_short ? curve.position(i) : Vec3f(blocks.x[i], blocks.y[i], blocks.z[i]);
  };
  const auto normal = [&](std::size_t i) { return is_short ? curve.normal(i) : Vec3f(blocks.nx[i], blocks.ny[i], blocks.nz[i]); };
  Eigen::AlignedBox3f box;
  Vec3f normals = Vec3f::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    box.extend(position(i));
    normals += normal(i);
  }
  bound.centre = box.center();
  const float length = normals.norm();
  bound.normal = length > 0 ? Vec3f(normals / length) : normal(begin);
  float step_of_normals = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const float radius = is_short ? extent_[i / kBlockSize] : blocks.radius[i] + extent_[i];
    const float spread = is_short ? 0 : blocks.spread[i];
    if (is_short && i > begin) step_of_normals = std::max(step_of_normals, (normal(i) - normal(i - 1)).norm());
    bound.radius = std::max(bound.radius, (position(i) - bound.centre).norm() + radius);
    const float off = is_short ? curve.normals_from(i, bound.normal) : (normal(i) - bound.normal).norm();
    bound.spread = std::max(bound.spread, off + spread);
  }
  bound.radius *= kSlack;
  // The normals within a leaf vary about as those of neighbouring leaves do.
  bound.spread = kSlack * (bound.spread + step_of_normals);
  return bound;
}

StratumBound StratumBounds::within_leaves(int level, std::uint64_t stratum) const {
  const std::vector<CurvePoint> points = strata_->spread_over(level, stratum, kSpread);
  StratumBound bound;
  bound.first_vertex = points.front().vertex;
  bound.last_vertex = points.back().vertex;
  bound.detail = most_detail(bound.first_vertex, bound.last_vertex);
  Eigen::AlignedBox3f box;
  Vec3f normals = Vec3f::Zero();
  for (const CurvePoint& p : points) {
    box.extend(Vec3f(p.position[0], p.position[1], p.position[2]));
    normals += Vec3f(p.normal[0], p.normal[1], p.normal[2]);
  }
  bound.centre = box.center();
  const float length = normals.norm();
  if (length > 0) bound.normal = normals / length;
  const bool has_beside = !strata_->curve().beside.empty();
  for (const CurvePoint& p : points) {
    bound.radius = std::max(bound.radius, (Vec3f(p.position[0], p.position[1], p.position[2]) - bound.centre).norm());
    bound.spread = std::max(bound.spread, (Vec3f(p.normal[0], p.normal[1], p.normal[2]) - bound.normal).norm());
    if (has_beside) bound.spread = std::max(bound.spread, strata_->curve().normals_from(p.vertex, bound.normal));
  }
  bound.radius *= kBeyond;
  bound.spread *= kBeyond;
  return bound;
}

}  // namespace curvecast
