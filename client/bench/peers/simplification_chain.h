// What users choose who do without point sets: a chain of levels of detail, made by meshoptimizer.
// Source: Garland, Heckbert, "Surface simplification using quadric error metrics" (1997), as meshoptimizer has it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// Simplifies a mesh to half of its triangles, and so on, until a level has at most `least_faces` or hardly fewer than the one
/// before, on one thread. Returns how many triangles each level has, without the mesh itself.
std::vector<std::size_t> simplification_chain(const TriangleMesh& mesh, std::size_t least_faces = 1000);

}  // namespace curvecast::cli::bench
