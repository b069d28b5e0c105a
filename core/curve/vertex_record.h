// What the mapper mixes of a mesh vertex, together in memory and in a form that mixes linearly.
#pragma once

#include "core/base/column.h"
#include "core/curve/tangent_frame.h"
#include "core/mesh/crease_normals.h"
#include "core/mesh/curvature.h"

namespace curvecast {

/// A normal, the curvatures, and the axis of the direction of curvature_max as a tensor (AxisTensor).
struct alignas(16) VertexRecord {
  static constexpr int kNormal = 0, kCurvatureMin = 3, kCurvatureMax = 4, kAxis = 5, kSize = 11;  // where they begin

  float values[kSize];
  float unused;
};
static_assert(sizeof(VertexRecord) == 12 * sizeof(float));

/// One for each vertex, then one for each normal beside a crease: its vertex's, with that normal.
Column<VertexRecord> vertex_records(const DifferentialGeometry& geometry, const CreaseNormals& creases);

}  // namespace curvecast
