// Converts a curve to messages.
#pragma once

#include <cstddef>

#include "core/curve/surface_curve.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::server {

/// Curve vertices of one message, at most: under 1 MiB.
inline constexpr std::size_t kChunkCurveVertices = 28'672;

/// Converts what a client must know before the chunks.
v1::CurveInfo to_curve_info(const SurfaceCurve& curve);

/// Converts the vertices from `begin` < curve.size() on: kChunkCurveVertices, or fewer where the disc ends.
v1::CurveChunk to_curve_chunk(const SurfaceCurve& curve, std::size_t begin);

}  // namespace curvecast::server
