// Takes what a soup carries over to the mesh that repair made of it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/face_list.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// `weld_map`: for each vertex of the soup the one that stands for it; may be empty: each for itself. `source`: the soup's vertex
/// of each vertex of the mesh. Welded vertices share the attributes of the first, and the mean of their normals. Where vertices
/// of different colours were welded and every polygon has a single colour, the colours become face colours.
MeshAttributes carry_attributes(const PolygonSoup& soup, const std::vector<std::uint32_t>& weld_map, const FaceList& faces,
                                const std::vector<std::uint32_t>& source);

}  // namespace curvecast
