// What the mapper mixes of a mesh vertex, together in memory and in a form that mixes linearly.
#pragma once

#include "core/column.h"
#include "core/curve/tangent_frame.h"
#include "core/mesh/curvature.h"

namespace curvecast {

struct alignas(16) VertexRecord {
  float normal[3];
  float curvature_min, curvature_max;
  AxisTensor axis;  // of the direction of curvature_max
  float unused;
};
static_assert(sizeof(VertexRecord) == 12 * sizeof(float));

/// One for each vertex.
Column<VertexRecord> vertex_records(const DifferentialGeometry& geometry);

}  // namespace curvecast
