// Divides every leaf of a curve: the quick way to a finer one where the whole surface needs it (paper, section 4.5).
#pragma once

#include "core/curve/curve_base.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// Makes the next revision, with every leaf divided `levels` (>= 1) times: 4^levels times as many vertices, but for leaves that
/// would go beyond kMaxLevel. No area is measured: each child takes an equal part of its parent's, as in the paper. That is exact
/// where the parent lay in one triangle; elsewhere the parent's points spread over its square instead of over its surface. All
/// else comes out as in a first build, but for the blocks, which are left empty. max_points grows with the number of vertices.
/// Precondition: fewer than 2^32 vertices come out.
SurfaceCurve subdivide_all(const CurveBase& base, const SurfaceCurve& curve, int levels);

}  // namespace curvecast
