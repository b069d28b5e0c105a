// What lies where on the curve, coarse to fine: the quadtree's nodes, each a contiguous range of curve vertices with bounds of
// all that a view or a density asks about. Source of the layout: Smits, "Efficiency issues for ray tracing" (1998), skip
// pointers.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/column.h"
#include "core/base/packed.h"
#include "core/base/vec.h"
#include "core/curve/curvature_measure.h"

namespace curvecast {

struct SurfaceCurve;

/// Smallest and largest value; empty (min > max) where there is none but NaN.
struct ValueBounds {
  float min = std::numeric_limits<float>::infinity();
  float max = -std::numeric_limits<float>::infinity();

  void extend(float value) {
    if (value < min) min = value;
    if (value > max) max = value;
  }
  void extend(const ValueBounds& other) {
    if (other.min < min) min = other.min;
    if (other.max > max) max = other.max;
  }
};

/// One cache line, saved to files as it is.
struct CurveNode {
  std::uint32_t first, last;               // its curve vertices: [first, last), never none
  std::uint32_t skip;                      // index of the next node that is not below this one; the next index at a leaf
  float area;                              // sum of the vertices' area elements
  float center[3], radius;                 // of a sphere that holds the vertices, relative to the curve's origin
  Snorm16 axis[3];                         // of a cone that holds the vertices' normals; of length 1 within rounding
  Snorm16 cosine;                          // of the cone's half angle; -1 for all directions, where it would exceed a right angle
  ValueBounds curvature[kCurvatureKinds];  // of curvature_measure

  std::uint32_t size() const { return last - first; }
  Vec3f sphere_center() const { return {center[0], center[1], center[2]}; }
  Vec3f cone_axis() const { return {axis[0], axis[1], axis[2]}; }
  bool has_cone() const { return cosine.code >= 0; }
  float cone_sine() const { return std::sqrt(1 - cosine * cosine); }  // where there is a cone
};
static_assert(sizeof(CurveNode) == 64);

/// Depth first, parents before their children: node 0 is the whole curve, its children are the discs, and so on down to
/// kMaxLeafVertices. Going to i + 1 enters node i, going to nodes[i].skip passes it by: no stack.
struct CurveHierarchy {
  static constexpr std::uint32_t kMaxLeafVertices = 64;

  Column<CurveNode> nodes;
  Column<ValueBounds> scalars;  // of node i and the curve's scalar s: [i S + s]

  bool is_leaf(std::size_t i) const { return nodes[i].skip == i + 1; }
  std::size_t byte_size() const { return nodes.size() * sizeof(CurveNode) + scalars.size() * sizeof(ValueBounds); }
};

/// Of a curve whose columns, area elements and disc_begin are there; of an empty curve, empty. Runs on all threads of the arena.
CurveHierarchy build_hierarchy(const SurfaceCurve& curve);

}  // namespace curvecast
