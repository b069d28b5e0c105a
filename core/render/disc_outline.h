// Where discs end at an outline: where the surface bends away from the eye. Internal to core/render.
//
// Where the surface bends away, a disc that is seen from its edge sticks out of it: outlines get teeth, and lie too far out.
// Where the surface is flat, however flatly it is seen, the whole disc lies on it, and a smaller one would leave gaps.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/render/splat_scene.h"

namespace curvecast {

/// The least slimness that there is.
inline constexpr float kLeastSlimness = 0.4F;

struct DiscOutline {
  float slimness = 1;  // in [kLeastSlimness, 1]: the share of the disc's extent towards and away from the eye that is drawn
  std::array<float, 4> plane{};  // ends the disc; see SplatVertex::ends. Zeros: it ends nowhere before its rim
};

/// Returns how a disc ends. With f the cosine between normal and direction to the eye, and k the surface's curvature away from
/// the eye, of neighbouring discs' normals, the surface ends f^2 / 2 k beyond the disc's middle, as the eye sees it: the plane
/// lies there, along the eye's rays. Of a disc that is seen flatly, and the last one before an outline, it lies at kLastReach of
/// the disc's own extent at most, since there may be anything beyond. `near`: numbers of neighbours.
DiscOutline disc_outline(std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near);
inline constexpr float kLastReach = 0.4F;

}  // namespace curvecast
