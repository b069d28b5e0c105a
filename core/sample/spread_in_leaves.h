// Gives points that the curve's vertices are too few for places of their own.
#pragma once

#include "core/curve/leaf_surface.h"
#include "core/sample/point_set.h"

namespace curvecast {

/// Spreads points that lie at the same curve vertex evenly along the curve within its leaf, on the surface: their positions,
/// normals, colours and, where `points` has any, places. The others stay at their vertices. Precondition: `points` were taken
/// from the surface's curve, in its order.
void spread_in_leaves(const LeafSurface& surface, PointSet& points);

/// Says whether any points lie at the same curve vertex.
bool shares_vertices(const PointSet& points);

/// Writes the place on its face of each point's curve vertex to points.places.
void find_places(const SurfaceCurve& curve, PointSet& points);

}  // namespace curvecast
