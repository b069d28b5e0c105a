// Makes a manifold, oriented triangle mesh out of whatever a file held, and says what it had to do.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>

#include "core/base/execution_context.h"
#include "core/mesh/face_sources.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct RepairReport {                       // counts
  std::uint64_t triangulated_polygons = 0;  // polygons of more than three corners
  std::uint64_t degenerate_faces = 0;       // dropped: repeated corner or no area
  std::uint64_t duplicate_faces = 0;        // dropped: the same three vertices again
  std::uint64_t welded_vertices = 0;        // merged into another at the same place
  std::uint64_t unused_vertices = 0;        // dropped: no face uses them
  std::uint64_t flipped_faces = 0;          // turned to agree with their neighbours
  std::uint64_t nonmanifold_edges = 0;      // split: more than two faces, or orientations that cannot agree
  std::uint64_t split_vertices = 0;         // extra vertices made where surfaces met in a point or a split edge
};

struct RepairedMesh {
  TriangleMesh mesh;
  MeshAttributes attributes;  // of the soup, for the mesh's vertices, corners and faces
  FaceSources sources;        // the soup's polygons that the mesh's faces are
  RepairReport report;
};

/// Triangulates, welds vertices at the same place (only those on a border of the soup's own connectivity, but all if
/// !soup.shares_vertices), drops degenerate and duplicate faces, orients, splits non-manifold edges and vertices, drops unused
/// vertices. Face order is kept. Closes nothing.
/// InvalidArgument when no face with an area is left.
absl::StatusOr<RepairedMesh> repair(PolygonSoup soup, const ExecutionContext& context = {});

}  // namespace curvecast
