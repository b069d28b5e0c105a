#include "core/curve/vertex_record.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace curvecast {

Column<VertexRecord> vertex_records(const DifferentialGeometry& geometry, const CreaseNormals& creases) {
  const std::size_t vertices = geometry.normals.size();
  Column<VertexRecord> records;
  records.resize(vertices + creases.normals.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices, 4096), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      const Vec3f& n = geometry.normals[v];
      const AxisTensor axis = axis_tensor(geometry.directions_max[v]);
      records[v] = {{n.x(), n.y(), n.z(), geometry.curvature_min[v], geometry.curvature_max[v], axis[0], axis[1], axis[2],
                     axis[3], axis[4], axis[5]},
                    0};
    }
  });
  for (std::size_t i = 0; i < creases.normals.size(); ++i) {
    const CreaseNormal& crease = creases.normals[i];
    VertexRecord& record = records[vertices + i];
    record = records[crease.vertex];
    for (int k = 0; k < 3; ++k) record.values[VertexRecord::kNormal + k] = crease.normal[k];
  }
  return records;
}

}  // namespace curvecast
