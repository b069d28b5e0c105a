// Joins triangles along the edges that they share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/mesh/face_list.h"

namespace curvecast {

struct HalfedgePairs {
  std::vector<std::uint32_t> twins;     // 3 F; kNone where there is none, and at edges of more than two faces
  std::vector<std::uint32_t> border;    // the halfedges of edges that only one face has, ascending
  std::uint64_t nonmanifold_edges = 0;  // of more than two faces
  bool is_oriented = true;              // all twins run in opposite directions
  bool may_have_duplicates = false;     // more than two faces at an edge, or two that share their third vertex too
};

/// Gives the halfedges (3 f + i, see TriangleMesh) of edges of exactly two faces to each other. Twins of faces whose orientations
/// disagree run the same way. Precondition: no triangle has the same vertex twice, all are below `vertex_count`. Any number of
/// threads gives the same. Once the context is cancelled some are missing.
HalfedgePairs pair_halfedges(const std::vector<Triangle>& triangles, std::size_t vertex_count,
                             const ExecutionContext& context = {});

/// Drops faces with the same three vertices as an earlier one; returns how many there were. Once the context is cancelled some
/// are kept.
std::uint64_t drop_duplicates(FaceList& faces, const ExecutionContext& context = {});

}  // namespace curvecast
