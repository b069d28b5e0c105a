#include "core/progressive/rank_chunk.h"

#include <array>
#include <cmath>

#include "core/density/picture_detail.h"

namespace curvecast {
namespace {

void fill_bounds(const StratumBounds& bounds, RankChunk& chunk) {
  RunBounds& out = chunk.bounds;
  constexpr int kRunLevels = 2;
  static_assert(kChunkRuns == 1u << 2 * kRunLevels);
  for (std::size_t r = 0; r < kChunkRuns; ++r) {
    const StratumBound bound = bounds.of(chunk.id.level - kChunkLevels + kRunLevels, chunk.id.index * kChunkRuns + r);
    out.x[r] = bound.centre.x(), out.y[r] = bound.centre.y(), out.z[r] = bound.centre.z();
    out.nx[r] = bound.normal.x(), out.ny[r] = bound.normal.y(), out.nz[r] = bound.normal.z();
    out.radius[r] = bound.radius;
    out.spread[r] = bound.spread;
    out.detail[r] = bound.detail;
    chunk.first_vertex[r] = bound.first_vertex;
    chunk.last_vertex[r] = bound.last_vertex;
  }
}

/// Returns the chunk's points in their order.
std::array<const RankedPoint*, kChunkStrata> in_layers(const ChunkId& id, std::span<const RankedPoint> points) {
  std::array<const RankedPoint*, kChunkStrata> ordered{};
  for (const RankedPoint& p : points) {
    if (p.rank < id.first_rank()) continue;
    const std::size_t layer = (p.rank - id.first_rank()) / id.layer_ranks();
    ordered[layer * kLayerStrata + id.stratum_in_layer(p.curve_position)] = &p;
  }
  return ordered;
}

}  // namespace

void fill_from_curve(const SurfaceCurve& curve, RankChunk& chunk) {
  const PictureDetail detail(curve);
  chunk.detail.clear();
  chunk.detail.reserve(chunk.size());
  for (const std::uint32_t vertex : chunk.vertex) chunk.detail.emplace_back(detail.at(vertex));
  chunk.beside.clear();
  chunk.runs_beside = 0;
  if (curve.beside.empty()) return;
  for (std::size_t i = 0; i < chunk.size(); ++i) {
    const bool is_beside = !curve.beside[chunk.vertex[i]].is_none();
    if (is_beside) chunk.runs_beside |= static_cast<std::uint16_t>(1 << i % kLayerStrata / kRunPoints);
  }
  if (chunk.runs_beside == 0) return;
  chunk.beside.reserve(chunk.size());
  for (const std::uint32_t vertex : chunk.vertex) chunk.beside.push_back(curve.beside[vertex]);
}

RankChunk make_chunk(const ChunkId& id, std::span<const RankedPoint> points, const StratumBounds& bounds,
                     const LeafSurface& surface) {
  RankChunk chunk;
  chunk.id = id;
  const double stratum_share = std::ldexp(1.0, -2 * id.level);
  const auto reserve = [n = chunk_points(id.level)](auto&... columns) { (columns.reserve(n), ...); };
  reserve(chunk.x, chunk.y, chunk.z, chunk.nx, chunk.ny, chunk.nz, chunk.rank, chunk.curve_position, chunk.vertex, chunk.face,
          chunk.weight_1, chunk.weight_2);
  if (surface.has_colour()) reserve(chunk.colour);
  for (const RankedPoint* at : in_layers(id, points)) {
    if (at == nullptr) continue;
    const RankedPoint& p = *at;
    chunk.x.push_back(p.position[0]);
    chunk.y.push_back(p.position[1]);
    chunk.z.push_back(p.position[2]);
    chunk.nx.emplace_back(p.normal[0]);
    chunk.ny.emplace_back(p.normal[1]);
    chunk.nz.emplace_back(p.normal[2]);
    chunk.rank.push_back(static_cast<std::uint32_t>(p.rank / id.rank_step()));
    chunk.curve_position.push_back(p.curve_position);
    chunk.vertex.push_back(p.vertex);
    chunk.face.push_back(p.face);
    chunk.weight_1.emplace_back(p.weight_1);
    chunk.weight_2.emplace_back(p.weight_2);
    if (surface.has_colour()) {
      chunk.colour.push_back(surface.colour(p.vertex, p.face, {p.weight_1, p.weight_2}, stratum_share));
    }
  }
  fill_from_curve(surface.curve(), chunk);
  fill_bounds(bounds, chunk);
  return chunk;
}

}  // namespace curvecast
