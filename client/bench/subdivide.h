// Refines a mesh: every triangle becomes four, on a curved surface through the same vertices.
// Source: Vlachos, Peters, Boyd, Mitchell, "Curved PN triangles" (2001).
#pragma once

#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// Triangle f becomes 4 f + i at its corner i and 4 f + 3 in its middle. The middles of the edges lie on cubic curves that follow
/// the vertices' normals, less than a quarter of the edge's length off the edge: the surface stays curved, not flat in patches.
TriangleMesh subdivide(const TriangleMesh& mesh);

}  // namespace curvecast::cli::bench
