// SPDX-License-Identifier: Apache-2.0
#include "client/lib/curve.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/lib/append_values.h"
#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

bool append_chunk(const v1::CurveChunk& chunk, CurveDisc& disc) {
  const std::size_t size = disc.size() + chunk.count();
  return append_values(chunk.positions(), disc.positions) && append_values(chunk.normals(), disc.normals) &&
         append_values(chunk.areas(), disc.areas) && append_values(chunk.cells(), disc.cells) &&
         append_values(chunk.levels(), disc.levels) && disc.positions.size() == size && disc.normals.size() == size &&
         disc.areas.size() == size && disc.cells.size() == size && disc.levels.size() == size;
}

bool is_sound(const CurveDisc& disc) {
  if (disc.size() == 0) return false;
  for (std::size_t l = 0; l < disc.size(); ++l) {
    if (disc.levels[l] > kMaxCurveLevel) return false;
    const std::uint32_t cells = std::uint32_t{1} << (kMaxCurveLevel - disc.levels[l]);  // on a side of the quad
    for (const std::uint32_t cell : disc.cells[l]) {
      if (cell >= std::uint32_t{1} << kMaxCurveLevel || cell % cells != 0) return false;
    }
    for (const std::int16_t n : disc.normals[l]) {
      if (n == std::numeric_limits<std::int16_t>::min()) return false;
    }
  }
  return std::all_of(disc.positions.begin(), disc.positions.end(),
                     [](const auto& p) { return std::all_of(p.begin(), p.end(), [](float x) { return std::isfinite(x); }); }) &&
         std::all_of(disc.areas.begin(), disc.areas.end(), [](float area) { return std::isfinite(area) && area >= 0; });
}

}  // namespace

double CurveDisc::side(std::size_t l) const { return std::ldexp(1.0, -levels[l]); }

std::array<double, 2> CurveDisc::centre(std::size_t l) const {
  const double half = 0.5 * side(l);
  return {std::ldexp(cells[l][0], -kMaxCurveLevel) + half, std::ldexp(cells[l][1], -kMaxCurveLevel) + half};
}

absl::StatusOr<Curve> decode_curve(std::span<const v1::GetCurveResponse> responses) {
  Curve curve;
  if (responses.empty() || !responses[0].has_info()) return absl::DataLossError("the server sent no curve");
  curve.info = responses[0].info();
  const v1::Vec3& origin = curve.info.origin();
  if (!std::isfinite(origin.x()) || !std::isfinite(origin.y()) || !std::isfinite(origin.z())) {
    return absl::DataLossError("the server sent a curve without a place");
  }
  std::uint64_t vertices = 0;
  for (const v1::GetCurveResponse& response : responses) {
    if (!response.has_chunk()) continue;
    const std::uint32_t d = response.chunk().disc();
    if (d == curve.discs.size()) curve.discs.emplace_back();
    if (d + std::size_t{1} != curve.discs.size() || !append_chunk(response.chunk(), curve.discs.back())) {
      return absl::DataLossError(absl::StrCat("the server sent a chunk of the curve of disc ", d, " that does not fit"));
    }
    vertices += response.chunk().count();
  }
  if (curve.discs.size() != curve.info.discs() || vertices != curve.info.curve_vertices()) {
    return absl::DataLossError(absl::StrCat("the server sent ", vertices, " curve vertices of ", curve.info.curve_vertices(),
                                            " and ", curve.discs.size(), " discs of ", curve.info.discs()));
  }
  for (std::size_t d = 0; d < curve.discs.size(); ++d) {
    if (!is_sound(curve.discs[d])) {
      return absl::DataLossError(absl::StrCat("the server sent a curve of disc ", d, " that makes no sense"));
    }
  }
  return curve;
}

}  // namespace curvecast::client
