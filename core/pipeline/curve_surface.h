// What a curve lies on, held together with the mesh that it is made of.
#pragma once

#include <absl/status/statusor.h>

#include <memory>

#include "core/curve/curve_base.h"
#include "core/curve/leaf_surface.h"
#include "core/pipeline/pipeline.h"

namespace curvecast {

/// Prepares the surface for refining curves and for finding places on it; keeps the mesh alive. CancelledError
/// alone can come of it.
absl::StatusOr<std::shared_ptr<const CurveBase>> curve_base(std::shared_ptr<const FlattenedMesh> flattened,
                                                            const ExecutionContext& context = {});

/// Returns the curve with the surface below its leaves. Precondition: it was made from a file, not loaded: `flattened` is there.
std::shared_ptr<const LeafSurface> leaf_surface(const Preprocessed& preprocessed);

}  // namespace curvecast
