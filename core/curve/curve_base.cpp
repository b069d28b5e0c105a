#include "core/curve/curve_base.h"

#include <tbb/parallel_for.h>

namespace curvecast {

CurveBase::CurveBase(const SurfaceData& surface, const std::vector<Chart>& all_charts)
    : data(surface), charts(all_charts), triangle_of(surface.mesh.face_count()) {
  for (const Chart& chart : charts) {
    const std::vector<std::uint32_t>& faces = chart.disc.face_of;
    for (std::size_t t = faces.size(); t-- > 0;) triangle_of[faces[t]] = static_cast<std::uint32_t>(t);
  }
  mappers.reserve(charts.size());
  fills_square.resize(charts.size());
  tbb::parallel_for(std::size_t{0}, charts.size(),
                    [&](std::size_t d) { fills_square[d] = fill_square(ChartTriangles(charts[d])); });
  for (const Chart& chart : charts) mappers.emplace_back(data, chart);
}

SurfaceCurve next_revision(const SurfaceCurve& curve) {
  SurfaceCurve next;
  next.origin = curve.origin;
  for (const ScalarColumn& scalar : curve.scalars) next.scalars.push_back({scalar.name, {}});
  next.reference_curvature = curve.reference_curvature;
  next.total_area = curve.total_area;
  next.box = curve.box;
  next.max_points = curve.max_points;
  next.revision = curve.revision + 1;
  return next;
}

}  // namespace curvecast
