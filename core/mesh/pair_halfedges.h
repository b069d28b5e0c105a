// Joins triangles along the edges that they share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/face_list.h"

namespace curvecast {

/// Halfedges (3 f + i, see TriangleMesh) sorted by the vertex pair that they join, as groups.
struct EdgeGroups {
  std::vector<std::uint32_t> halfedges;
  std::vector<std::uint32_t> begin;  // E + 1
};

EdgeGroups group_edges(const std::vector<Triangle>& triangles, std::size_t vertex_count);

/// Lists the vertices of edges that only one face has, ascending.
std::vector<std::uint32_t> border_vertices(const EdgeGroups& groups, const std::vector<Triangle>& triangles,
                                           std::size_t vertex_count);

struct HalfedgePairs {
  std::vector<std::uint32_t> twins;     // 3 F; kNone where there is none, and at edges of more than two faces
  std::uint64_t duplicate_faces = 0;    // dropped: the same three vertices as an earlier one
  std::uint64_t nonmanifold_edges = 0;  // of more than two faces
};

/// Drops duplicates from `faces`, and gives the halfedges of edges of exactly two faces to each other. Twins of faces whose
/// orientations disagree run the same way.
HalfedgePairs pair_halfedges(FaceList& faces, EdgeGroups groups, std::size_t vertex_count);

}  // namespace curvecast
