#include "server/convert/curve_chunks.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/curve/hilbert.h"
#include "server/convert/convert.h"
#include "server/convert/little_endian.h"

namespace curvecast::server {

v1::CurveInfo to_curve_info(const SurfaceCurve& curve) {
  v1::CurveInfo info;
  info.set_curve_vertices(curve.size());
  info.set_discs(static_cast<std::uint32_t>(curve.disc_begin.empty() ? 0 : curve.disc_begin.size() - 1));
  info.set_revision(curve.revision);
  *info.mutable_origin() = to_proto(curve.origin);
  return info;
}

v1::CurveChunk to_curve_chunk(const SurfaceCurve& curve, std::size_t begin) {
  const auto next_disc = std::upper_bound(curve.disc_begin.begin(), curve.disc_begin.end(), begin);
  const std::size_t count = std::min(kChunkCurveVertices, *next_disc - begin);
  std::vector<std::array<float, 3>> positions(count);
  std::vector<std::array<std::int16_t, 3>> normals(count);
  std::vector<std::array<std::uint32_t, 2>> cells(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t l = begin + i;
    positions[i] = {curve.x[l], curve.y[l], curve.z[l]};
    normals[i] = {curve.nx[l].code, curve.ny[l].code, curve.nz[l].code};
    // The key is that of the first cell that the curve meets in the quad, whichever corner that is.
    const int up = kMaxLevel - curve.level[l];
    const HilbertCell cell = hilbert_cell(curve.key[l] >> (2 * up), curve.level[l]);
    cells[i] = {cell.x << up, cell.y << up};
  }
  v1::CurveChunk chunk;
  chunk.set_disc(static_cast<std::uint32_t>(next_disc - curve.disc_begin.begin() - 1));
  chunk.set_count(static_cast<std::uint32_t>(count));
  chunk.set_positions(little_endian(positions, 0, count));
  chunk.set_normals(little_endian(normals, 0, count));
  chunk.set_areas(little_endian(curve.area, begin, count));
  chunk.set_cells(little_endian(cells, 0, count));
  chunk.set_levels(little_endian(curve.level, begin, count));
  return chunk;
}

}  // namespace curvecast::server
