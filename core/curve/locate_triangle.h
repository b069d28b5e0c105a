// Finds triangles of a chart by walking across its edges, without lists of them.
// Source: Devillers, Pion, Teillaud, "Walking in a triangulation" (2002).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"

namespace curvecast {

/// The triangles of a chart in the square, and their neighbours. The chart outlives it.
struct ParameterMesh {
  explicit ParameterMesh(const ChartView& chart) : triangles(chart), twins(chart.twins) {}

  ChartTriangles triangles;
  std::span<const std::uint32_t> twins;  // of its disc, see TriangleMesh
};

/// Finds the triangle that holds a point of the square, by a walk from `start`: a few steps where that is near. A point on an
/// edge, within rounding, goes to one of its triangles, always the same from the same start.
std::uint32_t find_triangle(const ParameterMesh& mesh, const Vec2d& p, std::uint32_t start);

/// Finds the triangles of four points that lie near one another: each triangle on the way is tried for all of them. u, v and
/// `found` have four entries. A point on an edge may go to the other of its triangles than find_triangle() says.
void find_four_triangles(const ParameterMesh& mesh, const double* u, const double* v, std::uint32_t start, std::uint32_t* found);

/// Lists the triangles that touch quads. One for each thread: it keeps a mark for every triangle.
class TouchingTriangles {
 public:
  explicit TouchingTriangles(const ParameterMesh& mesh) : mesh_(mesh), marked_(mesh.triangles.size(), false) {}

  /// Writes all triangles that overlap or touch the quad, ascending; `start` is any triangle, the nearer the faster.
  void find(const Quad& quad, std::uint32_t start, std::vector<std::uint32_t>& found);

 private:
  ParameterMesh mesh_;
  std::vector<bool> marked_;  // all false between two calls
  std::vector<std::uint32_t> seen_;
};

/// Tells whether a triangle and a quad share a point (separating axes).
bool touches(const UvTriangle& triangle, const Quad& quad);

}  // namespace curvecast
