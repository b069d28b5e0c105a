#include "core/sample/sample_ranked.h"

#include <algorithm>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cmath>

#include "core/density/view_factor.h"
#include "core/sample/rank_delta.h"
#include "core/sample/resample.h"
#include "core/sample/splat_radius.h"

namespace curvecast {
namespace {

/// Along the curve.
void sort_by_place(const RankTree& tree, std::vector<RankRef>& points) {
  std::vector<std::uint64_t> keys(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    keys[i] = std::uint64_t{tree.chunks()[points[i].chunk]->place[points[i].point]} << 32 | i;
  }
  boost::sort::spreadsort::integer_sort(keys.begin(), keys.end());
  std::vector<RankRef> sorted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sorted[i] = points[static_cast<std::uint32_t>(keys[i])];
  points.swap(sorted);
}

/// The data of the points of a selection, in this order.
void gather(const SurfaceCurve& curve, const RankSelection& selection, std::span<const RankRef> refs, const FixedDensity* density,
            const ViewFactor& view, PointSet& points) {
  const RankTree& tree = *selection.tree;
  const std::size_t n = refs.size();
  points.origin = curve.origin;
  points.positions.resize(n);
  points.normals.resize(n);
  points.radii.resize(n);
  points.vertices.resize(n);
  points.ranks.resize(n);
  // With scale s a point stands for 1 / (s density) of the area.
  const SplatRadius radius(curve, curve.total_area / static_cast<double>(selection.scale));
  constexpr std::size_t kChunk = 256;
  float x[kChunk], y[kChunk], z[kChunk], factor[kChunk];
  std::uint32_t place[kChunk];
  Snorm16 nx[kChunk], ny[kChunk], nz[kChunk];
  for (std::size_t begin = 0; begin < n; begin += kChunk) {
    const std::size_t count = std::min(kChunk, n - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const RankChunk& chunk = *tree.chunks()[refs[begin + i].chunk];
      const std::uint32_t p = refs[begin + i].point;
      x[i] = chunk.x[p], y[i] = chunk.y[p], z[i] = chunk.z[p];
      nx[i] = chunk.nx[p], ny[i] = chunk.ny[p], nz[i] = chunk.nz[p];
      factor[i] = density == nullptr ? 1 : density->density[chunk.vertex[p]];
      place[i] = chunk.place[p];
      points.vertices[begin + i] = chunk.vertex[p];
      points.ranks[begin + i] = chunk.rank[p];
    }
    view.multiply(x, y, z, nx, ny, nz, count, factor);
    for (std::size_t i = 0; i < count; ++i) {
      points.positions[begin + i] = {x[i], y[i], z[i]};
      points.normals[begin + i] = {nx[i], ny[i], nz[i]};
      // Where points are lacking, those that there are have to do.
      const float most =
          selection.lacking.empty()
              ? factor[i]
              : static_cast<float>(std::ldexp(1.0, 2 * tree.level_at(refs[begin + i].chunk, place[i]))) / selection.scale;
      points.radii[begin + i] = radius(std::min(factor[i], most));
    }
  }
  points.colours.resize(curve.colour.empty() ? 0 : n);
  for (std::size_t i = 0; i < points.colours.size(); ++i) points.colours[i] = curve.colour[points.vertices[i]];
}

}  // namespace

absl::Status sample_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, ResampleWorkspace& workspace) {
  if (absl::Status status = check_sample(n, density); !status.ok()) return status;
  const ViewFactor view(curve, density);
  RankSelection& selection = workspace.selection;
  workspace.selector.select(tree, fixed, view, n, selection);
  if (selection.count == 0 && selection.lacking.empty()) return nowhere_to_put_points();
  list_shown(selection, workspace.refs);
  sort_by_place(*tree, workspace.refs);
  gather(curve, selection, workspace.refs, fixed, view, workspace.points);
  selection.tree.reset();  // it may be large, and others wait for its place
  return absl::OkStatus();
}

}  // namespace curvecast
