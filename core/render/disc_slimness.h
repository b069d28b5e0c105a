// How slim discs are where they are seen from the side. Internal to core/render.
//
// Where the surface bends away from the eye, a disc that is seen from its edge sticks out of it: outlines get teeth. Where the
// surface is flat, however flatly it is seen, the whole disc lies on it, and a slimmer one would leave gaps.
#pragma once

#include <cstdint>
#include <span>

#include "core/render/splat_scene.h"

namespace curvecast {

/// The least that there is.
inline constexpr float kLeastSlimness = 0.4F;

/// Returns the share, in [kLeastSlimness, 1], of a disc's extent away from the eye that is to be drawn. With f the cosine between
/// normal and direction to the eye, and k the surface's curvature away from the eye, of neighbouring discs' normals, the surface
/// ends at f / k in the disc's plane, f^2 / 2 k beyond its middle as the eye sees it; the disc at r f. `near`: numbers of
/// neighbours.
float disc_slimness(std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near);

}  // namespace curvecast
