// SPDX-License-Identifier: Apache-2.0
#include "client/lib/parameter_mesh.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>

#include "client/lib/append_values.h"

namespace curvecast::client {
namespace {

bool append_chunk(const v1::ParameterDiscChunk& chunk, ParameterDisc& disc) {
  return append_values(chunk.positions(), disc.positions) && append_values(chunk.uv(), disc.uv) &&
         append_values(chunk.triangles(), disc.triangles) && append_values(chunk.faces(), disc.faces) &&
         append_values(chunk.area_ratios(), disc.area_ratios) && append_values(chunk.border(), disc.border) &&
         append_values(chunk.border_cuts(), disc.border_cuts);
}

bool is_sound(const ParameterDisc& disc, std::uint64_t faces) {
  const std::size_t n = disc.positions.size();
  if (disc.triangles.empty() || disc.uv.size() != n || disc.faces.size() != disc.triangles.size() ||
      disc.area_ratios.size() != disc.triangles.size() || disc.border.size() != disc.border_cuts.size()) {
    return false;
  }
  const auto all = [](const auto& values, auto&& holds) { return std::all_of(values.begin(), values.end(), holds); };
  const auto is_vertex = [n](std::uint32_t v) { return v < n; };
  return all(disc.triangles, [&](const auto& t) { return all(t, is_vertex); }) && all(disc.border, is_vertex) &&
         all(disc.faces, [&](std::uint32_t f) { return f < faces; }) &&
         all(disc.positions, [&](const auto& p) { return all(p, [](double x) { return std::isfinite(x); }); }) &&
         all(disc.uv, [&](const auto& p) { return all(p, [](double x) { return x >= 0 && x <= 1; }); }) &&
         all(disc.area_ratios, [](double r) { return std::isfinite(r) && r >= 0; });
}

}  // namespace

absl::StatusOr<ParameterMesh> decode_parameter_mesh(std::span<const v1::GetParameterMeshResponse> responses) {
  ParameterMesh mesh;
  if (responses.empty() || !responses[0].has_info()) return absl::DataLossError("the server sent no parameter mesh");
  mesh.info = responses[0].info();
  for (const v1::GetParameterMeshResponse& response : responses) {
    if (!response.has_chunk()) continue;
    const std::uint32_t d = response.chunk().disc();
    if (d == mesh.discs.size()) mesh.discs.emplace_back();
    if (d + std::size_t{1} != mesh.discs.size() || !append_chunk(response.chunk(), mesh.discs.back())) {
      return absl::DataLossError(absl::StrCat("the server sent a chunk of disc ", d, " that does not fit"));
    }
  }
  if (mesh.discs.size() != mesh.info.discs()) {
    return absl::DataLossError(absl::StrCat("the server sent ", mesh.discs.size(), " discs of ", mesh.info.discs()));
  }
  for (std::size_t d = 0; d < mesh.discs.size(); ++d) {
    if (!is_sound(mesh.discs[d], mesh.info.mesh().faces())) {
      return absl::DataLossError(absl::StrCat("the server sent a disc ", d, " that makes no sense"));
    }
  }
  return mesh;
}

}  // namespace curvecast::client
