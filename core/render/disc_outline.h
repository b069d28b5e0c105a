// Where discs end at an outline: where the surface bends away from the eye. Internal to core/render.
//
// Where the surface bends away, a disc that is seen from its edge sticks out of it: outlines get teeth, and lie too far out.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/render/splat_scene.h"

namespace curvecast {

/// Returns the plane at which a disc ends towards an outline, as one of SplatVertex::ends; zeros: it ends nowhere before its
/// rim. With f the cosine between normal and direction to the eye, the surface ends f^2 / 2 k beyond the disc's middle as the
/// eye sees it: the plane lies along the eye's rays, halfway there, since the last discs blend. k, the surface's curvature
/// towards there, is that of the neighbours' normals, or that of those places beyond the disc that hide the least, whichever is
/// more: where a surface is rough, normals do not tell where it ends. `near`: numbers of neighbours; those whose normals have a
/// smaller cosine than `crease_cosine` lie beyond a crease.
std::array<float, 4> disc_outline(std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near,
                                  float crease_cosine);

}  // namespace curvecast
