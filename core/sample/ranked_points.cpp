#include "core/sample/ranked_points.h"

#include <algorithm>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cmath>

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

}  // namespace

PointSet ranked_points(const SurfaceCurve& curve, const RankSelection& selection, std::vector<RankRef> refs,
                       const RankDensity& density, const ViewFactor& view) {
  const RankTree& tree = *selection.tree;
  sort_by_place(tree, refs);
  const std::size_t n = refs.size();
  PointSet points;
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
      factor[i] = density.at_vertex.empty() ? 1 : density.at_vertex[chunk.vertex[p]];
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
  if (!curve.colour.empty()) {
    points.colours.resize(n);
    for (std::size_t i = 0; i < n; ++i) points.colours[i] = curve.colour[points.vertices[i]];
  }
  return points;
}

}  // namespace curvecast
