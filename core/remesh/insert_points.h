// Makes points of a surface vertices of its mesh.
#pragma once

#include <cstdint>
#include <span>

#include "core/remesh/halfedge_mesh.h"
#include "core/sample/point_set.h"

namespace curvecast {

/// A place on the border of a mesh: on the edge that leaves `vertex` along the border, at `part` of its length, within (0, 1).
struct BorderPlace {
  std::uint32_t vertex;
  double part;
};

/// Adds one vertex for each point, numbered in their order from the first free number on, in faces of their own around it. Each
/// is moved by up to 1e-5 of its face, off the edges and off lines that it shares with others; those at the same place as
/// another, farther. Precondition: the faces are those that the mesh came with.
void insert_points(HalfedgeMesh& mesh, std::span<const FacePlace> points);

/// The same for points on borders. Those of one edge follow each other by `part`.
void insert_border_points(HalfedgeMesh& mesh, std::span<const BorderPlace> points);

}  // namespace curvecast
