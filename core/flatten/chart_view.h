// A chart where it lies, in memory or in a mapped file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/flatten/flatten.h"

namespace curvecast {

/// See DiscMesh and Chart, which outlives it.
struct ChartView : MeshView {
  ChartView() = default;
  ChartView(const Chart& chart) : ChartView(chart.disc, chart.uv) {}  // NOLINT: it is one
  ChartView(const DiscMesh& disc, std::span<const Vec2d> disc_uv)
      : MeshView(disc), twins(disc.twins), face_of(disc.face_of), uv(disc_uv) {}

  std::span<const std::uint32_t> twins;    // 3 F
  std::span<const std::uint32_t> face_of;  // F
  std::span<const Vec2d> uv;               // V
};

}  // namespace curvecast
