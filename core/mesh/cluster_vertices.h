// A coarse stand-in of a great mesh, in a single pass.
#pragma once

#include <cstddef>

#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// Merges the vertices in each cell of a grid into their mean, and keeps of the polygons, as fans of triangles, those whose
/// corners lie in three cells, each once and folds not at all (Rossignac and Borrel, "Multi-resolution 3D approximations for
/// rendering complex scenes", 1993). The cells are chosen for about `vertices` of them to hold any, however many the soup has:
/// where it has fewer, most cells hold one. Colours and scalars of vertices are means too, the rest is that of the first polygon;
/// normals go. May be empty, and needs repair as any soup. Precondition: vertices > 0.
PolygonSoup cluster_vertices(const PolygonSoup& soup, std::size_t vertices);

}  // namespace curvecast
