// A part of a mesh as a mesh of its own.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Makes a mesh of some faces of a repaired mesh, those with these numbers (ascending), in their order; twins that leave them
/// become border. Vertices are numbered by first corner; one that the faces touch from several sides becomes several, so that the
/// piece is manifold.
TriangleMesh extract_piece(const TriangleMesh& mesh, std::span<const std::uint32_t> faces);

}  // namespace curvecast
