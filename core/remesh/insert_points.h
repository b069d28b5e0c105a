// Makes points of a surface vertices of its mesh.
#pragma once

#include <cstdint>
#include <span>

#include "core/remesh/halfedge_mesh.h"
#include "core/sample/point_set.h"

namespace curvecast {

/// A place on an edge of a surface: at `part` of the halfedge's length, within (0, 1).
struct LinePlace {
  std::uint32_t halfedge;
  double part;
};

/// Adds one vertex for each point, numbered in their order from the first free number on, in faces of their own around it. Each
/// is moved by up to 1e-5 of its face, off the edges and off lines that it shares with others; those at the same place as
/// another, farther. Precondition: the faces are those that the mesh came with.
void insert_points(HalfedgeMesh& mesh, std::span<const FacePlace> points);

/// The same for points on edges that are on the border, or marked as features. Those of one edge follow each other by `part`.
/// `surface`: the mesh as it came.
void insert_line_points(HalfedgeMesh& mesh, const TriangleMesh& surface, std::span<const LinePlace> points);

}  // namespace curvecast
