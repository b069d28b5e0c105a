// What a curve lies on, held together with the mesh that it is made of.
#pragma once

#include <memory>

#include "core/curve/curve_base.h"
#include "core/curve/leaf_surface.h"
#include "core/pipeline/pipeline.h"

namespace curvecast {

/// Prepares the surface for refining curves and for finding places on it; keeps the mesh alive.
std::shared_ptr<const CurveBase> curve_base(std::shared_ptr<const FlattenedMesh> flattened);

/// Returns the curve with the surface below its leaves. Precondition: it was made from a file, not loaded: `flattened` is there.
std::shared_ptr<const LeafSurface> leaf_surface(const Preprocessed& preprocessed);

}  // namespace curvecast
