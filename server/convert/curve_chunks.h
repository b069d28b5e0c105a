// Packs a curve into messages.
#pragma once

#include <cstddef>

#include "core/curve/surface_curve.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

/// Curve vertices in one message: under 1 MiB.
inline constexpr std::size_t kChunkCurveVertices = 28'672;

v1::CurveInfo to_curve_info(const SurfaceCurve& curve);

/// The chunk that begins with vertex `begin` < curve.size() and ends with its disc at the latest.
v1::CurveChunk to_curve_chunk(const SurfaceCurve& curve, std::size_t begin);

}  // namespace curvecast::server
