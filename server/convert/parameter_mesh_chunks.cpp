#include "server/convert/parameter_mesh_chunks.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/flatten/border_cuts.h"
#include "core/flatten/distortion.h"
#include "server/convert/convert.h"
#include "server/convert/little_endian.h"

namespace curvecast::server {
namespace {

/// The part of n elements that chunk i holds: begin and count.
std::pair<std::size_t, std::size_t> part(std::size_t n, std::size_t chunk, std::size_t i) {
  const std::size_t begin = std::min(n, chunk * i);
  return {begin, std::min(chunk, n - begin)};
}

std::size_t chunks_of(std::size_t n, std::size_t chunk) { return (n + chunk - 1) / chunk; }

}  // namespace

absl::Status make_chunks(const FlattenedMesh& flattened, const std::string& mesh_name,
                         const std::function<bool(v1::GetParameterMeshResponse)>& emit) {
  absl::Status gone = absl::CancelledError("the client has gone");
  v1::GetParameterMeshResponse first;
  *first.mutable_info()->mutable_mesh() = to_proto(flattened.report.mesh, mesh_name);
  first.mutable_info()->set_discs(flattened.report.discs);
  *first.mutable_info()->mutable_distortion() = to_proto(flattened.report.distortion);
  if (!emit(std::move(first))) return gone;
  for (std::size_t d = 0; d < flattened.charts.size(); ++d) {
    const Chart& chart = flattened.charts[d];
    const DiscMesh& disc = chart.disc;
    const std::vector<bool> cuts = border_cuts(flattened.loaded.mesh, disc);
    const std::vector<std::uint8_t> cut_bytes(cuts.begin(), cuts.end());
    const std::size_t chunks =
        std::max({chunks_of(disc.vertex_count(), kChunkVertices), chunks_of(disc.triangles.size(), kChunkTriangles),
                  chunks_of(disc.border.size(), kChunkBorder)});
    for (std::size_t i = 0; i < chunks; ++i) {
      v1::GetParameterMeshResponse response;
      v1::ParameterDiscChunk& out = *response.mutable_chunk();
      out.set_disc(static_cast<std::uint32_t>(d));
      const auto [vertex, vertices] = part(disc.vertex_count(), kChunkVertices, i);
      out.set_positions(little_endian(disc.positions, vertex, vertices));
      out.set_uv(little_endian(chart.uv, vertex, vertices));
      const auto [triangle, triangles] = part(disc.triangles.size(), kChunkTriangles, i);
      out.set_triangles(little_endian(disc.triangles, triangle, triangles));
      std::vector<std::uint32_t> faces(triangles);
      for (std::size_t t = 0; t < triangles; ++t) faces[t] = flattened.loaded.sources.polygon(disc.face_of[triangle + t]);
      out.set_faces(little_endian(faces, 0, triangles));
      std::vector<double> area_ratios(triangles);
      for (std::size_t t = 0; t < triangles; ++t) area_ratios[t] = area_ratio({disc, chart.uv}, triangle + t);
      out.set_area_ratios(little_endian(area_ratios, 0, triangles));
      const auto [border, borders] = part(disc.border.size(), kChunkBorder, i);
      out.set_border(little_endian(disc.border, border, borders));
      out.set_border_cuts(little_endian(cut_bytes, border, borders));
      if (!emit(std::move(response))) return gone;
    }
  }
  return absl::OkStatus();
}

}  // namespace curvecast::server
