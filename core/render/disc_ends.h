// Where discs end before their rim: along creases, where the surface goes on in another direction, and at outlines (see
// disc_outline.h). Internal to core/render.
//
// A disc that reaches over a crease would stick out of the surface. What each side of one has is its plane: both discs end where
// their planes meet. Clip lines of splats at sharp features: Zwicker, Räsänen, Botsch, Dachsbacher, Pauly, "Perspective Accurate
// Splatting", Graphics Interface 2004, section 5. There they come with the points; here they are found from neighbours.
#pragma once

#include <span>

#include "core/render/splat_scene.h"

namespace curvecast {

/// Finds where they end for all splats, of what else they have: sets SplatVertex::ends. On all threads. Neighbours whose normals
/// are further apart than `crease_degrees`, 0 .. 180, and than what rounding makes of normals, lie on two sides of a crease.
void find_disc_ends(std::span<SplatVertex> splats, double crease_degrees);

}  // namespace curvecast
