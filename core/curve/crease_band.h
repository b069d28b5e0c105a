// Where a curve runs beside a crease: what the surface faces on the other side. A picture needs points there although they face
// away from the eye, where the other side is seen: a disc ends at a crease only where it has neighbours beyond.
#pragma once

#include <cstddef>

#include "core/base/execution_context.h"
#include "core/curve/surface_curve.h"
#include "core/curve/surface_map.h"

namespace curvecast {

/// How far from a crease a vertex is beside it, in diagonals of the curve's box: about two spacings of 20,000 points.
inline constexpr double kCreaseBand = 0.015;
/// Of more faces that creases meet, their bands would be everywhere, and the work would take memory that nobody has set aside.
inline constexpr std::size_t kMostCreaseFaces = 500'000;

/// Sets curve.beside from its positions and normals and the surface's creases; leaves it empty where no vertex is beside one, or
/// there are more than kMostCreaseFaces. A finer curve has it from the coarser, by beside_within().
/// Runs on all threads of the arena; is cut short, with a column that means nothing, once the context is cancelled.
void fill_crease_band(const SurfaceData& data, SurfaceCurve& curve, const ExecutionContext& context = {});

/// Returns what lies beside a part of vertex l's leaf that faces `normal`: on the crease's other side that is what l itself
/// faces. Precondition: curve.beside is not empty.
Direction8 beside_within(const SurfaceCurve& curve, std::size_t l, const Vec3f& normal);

}  // namespace curvecast
