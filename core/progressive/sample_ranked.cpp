#include "core/progressive/sample_ranked.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/simd.h"
#include "core/density/view_factor.h"
#include "core/progressive/progressive.h"
#include "core/progressive/sort_along_curve.h"
#include "core/sample/resample.h"
#include "core/sample/splat_radius.h"

namespace curvecast {
namespace {

constexpr std::size_t kAhead = 12;  // points whose data the memory brings beforehand

void prefetch(const RankSelection& selection, const RankRef& ref) {
  const RankChunk& chunk = selection.chunk(ref);
  for (const AlignedVector<float>* column : {&chunk.x, &chunk.y, &chunk.z}) __builtin_prefetch(column->data() + ref.point);
  for (const AlignedVector<Snorm16>* column : {&chunk.nx, &chunk.ny, &chunk.nz}) __builtin_prefetch(column->data() + ref.point);
  __builtin_prefetch(chunk.rank.data() + ref.point);
  __builtin_prefetch(chunk.vertex.data() + ref.point);
}

CURVECAST_WIDE void to_rungs(const SplatRadius& radius, const float* __restrict density, std::size_t n,
                             std::uint8_t* __restrict rungs) {
  const SplatRadius own = radius;  // which no store to `rungs` changes
  for (std::size_t i = 0; i < n; ++i) rungs[i] = own.rung(density[i]);
}

/// Lowers the densities of the points shown to those for which the tree has points: where it lacks some, those that there are
/// have to do.
void limit_to_tree(const RankSelection& selection, std::span<float> density) {
  std::array<float, kMaxRankLevel + 1> most;
  for (int level = 0; level <= kMaxRankLevel; ++level) {
    most[static_cast<std::size_t>(level)] = static_cast<float>(std::ldexp(1.0, 2 * level)) / selection.scale;
  }
  std::vector<std::uint64_t> lacking;  // where that begins on the curve
  for (const ChunkId& id : selection.lacking) lacking.push_back(id.first_position());
  std::ranges::sort(lacking);
  std::size_t i = 0;
  for (std::size_t p = 0; p < selection.parts.size(); ++p) {
    const RankChunk& chunk = *selection.parts[p].chunk;
    const auto next = std::ranges::lower_bound(lacking, chunk.id.first_position());
    if (!selection.is_exhausted && (next == lacking.end() || *next > chunk.id.last_position())) {
      i += selection.count_of(p);
      continue;
    }
    selection.for_each_shown_of(p, [&](std::size_t point) {
      const int level = selection.tree->level_at(selection.parts[p].index, chunk.curve_position[point]);
      density[i] = std::min(density[i], most[static_cast<std::size_t>(level)]);
      ++i;
    });
  }
}

/// The discs of all points that a selection shows.
void find_rungs(const SurfaceCurve& curve, const RankSelector& selector, std::vector<float>& density, RankSelection& selection) {
  density.resize(selection.count);
  selector.densities(selection, density);
  // With scale s a point stands for 1 / (s density) of the area.
  const SplatRadius radius(curve, curve.total_area / static_cast<double>(selection.scale));
  if (!selection.lacking.empty() || selection.is_exhausted) limit_to_tree(selection, density);
  selection.rungs.resize(selection.count);
  to_rungs(radius, density.data(), selection.count, selection.rungs.data());
}

}  // namespace

absl::Status select_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, RankedWorkspace& workspace, double expected_scale) {
  if (absl::Status status = check_sample(n, density); !status.ok()) return status;
  RankSelection& selection = workspace.selection;
  workspace.selector.select(tree, fixed, ViewFactor(curve, density), n, selection, expected_scale);
  if (selection.count == 0 && selection.lacking.empty()) return nowhere_to_put_points();
  find_rungs(curve, workspace.selector, workspace.density, selection);
  return absl::OkStatus();
}

void gather_ranked(const SurfaceCurve& curve, const RankSelection& selection, std::span<const RankRef> refs, PointSet& points,
                   bool with_places) {
  const std::size_t n = refs.size();
  points.origin = curve.origin;
  points.positions.resize(n);
  points.normals.resize(n);
  points.radii.resize(n);
  points.vertices.resize(n);
  points.ranks.resize(n);
  points.places.resize(with_places ? n : 0);
  points.colours.resize(curve.colour.empty() ? 0 : n);
  const RadiusLadder ladder(SplatRadius::largest(curve));
  for (std::size_t i = 0; i < n; ++i) {
    prefetch(selection, refs[std::min(i + kAhead, n - 1)]);
    const RankChunk& chunk = selection.chunk(refs[i]);
    const std::uint16_t p = refs[i].point;
    points.positions[i] = Vec3f(chunk.x[p], chunk.y[p], chunk.z[p]);
    points.normals[i] = {chunk.nx[p], chunk.ny[p], chunk.nz[p]};
    points.radii[i] = ladder.radius(refs[i].rung);
    points.vertices[i] = chunk.vertex[p];
    points.ranks[i] = static_cast<std::uint32_t>(std::min<std::uint64_t>(chunk.rank_of(p), UINT32_MAX));
    if (with_places) points.places[i] = {chunk.face[p], chunk.weight_1[p], chunk.weight_2[p]};
    if (!points.colours.empty()) points.colours[i] = chunk.colour[p];
  }
}

void list_ranked(const SurfaceCurve& curve, RankedWorkspace& workspace, bool with_places) {
  const RankSelection& selection = workspace.selection;
  std::vector<RankRef>& shown = workspace.shown;
  ListDelta::Scratch& scratch = workspace.list_delta.of_added;
  shown.clear();
  scratch.keys.clear();
  selection.for_each_shown([&](const RankRef& ref, std::size_t) {
    scratch.keys.push_back(curve_key(selection.chunk(ref).curve_position[ref.point], shown.size()));
    shown.push_back(ref);
  });
  sort_along_curve(scratch.keys, scratch.sorting, shown, workspace.refs);
  gather_ranked(curve, selection, workspace.refs, workspace.points, with_places);
}

absl::Status sample_ranked(const SurfaceCurve& curve, const std::shared_ptr<const RankTree>& tree, const FixedDensity* fixed,
                           const Density& density, std::uint64_t n, RankedWorkspace& workspace) {
  if (absl::Status status = select_ranked(curve, tree, fixed, density, n, workspace); !status.ok()) return status;
  list_ranked(curve, workspace);
  return absl::OkStatus();
}

}  // namespace curvecast
