// What users choose who make a mesh of fewer, or of better, triangles without point sets.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>

#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// A peer's mesh, made manifold where it was not.
struct PeerMesh {
  TriangleMesh mesh;
  std::size_t broken = 0;  // edges and vertices that were not manifold
  double seconds = 0;      // of the peer's own work alone
};

/// Isotropic remeshing by splits, collapses, flips, relaxation and projection, in three rounds, by CGAL. Source: Botsch, Kobbelt,
/// "A remeshing approach to multiresolution modeling" (2004). It takes a length of edges: the number of vertices comes near to n
/// by trying twice, and the second try is timed.
absl::StatusOr<PeerMesh> remesh_isotropic_cgal(const TriangleMesh& mesh, std::size_t n);

/// Edge collapse down to n vertices, about: by quadrics (Garland, Heckbert, "Surface simplification using quadric error metrics",
/// 1997), or without memory of the mesh (Lindstrom, Turk, "Fast and memory efficient polygonal simplification", 1998); by CGAL.
absl::StatusOr<PeerMesh> collapse_garland_heckbert_cgal(const TriangleMesh& mesh, std::size_t n);
absl::StatusOr<PeerMesh> collapse_lindstrom_turk_cgal(const TriangleMesh& mesh, std::size_t n);

/// Edge collapse by quadrics onto vertices of the mesh, by meshoptimizer.
absl::StatusOr<PeerMesh> simplify_meshoptimizer(const TriangleMesh& mesh, std::size_t n);

}  // namespace curvecast::cli::bench
