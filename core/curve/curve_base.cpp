#include "core/curve/curve_base.h"

#include <tbb/parallel_for.h>

#include <utility>

#include "core/base/for_all.h"

namespace curvecast {
namespace {

std::vector<BaseChart> base_charts(const SurfaceData& data, std::span<const Chart> charts, const ExecutionContext& context) {
  std::vector<BaseChart> out(charts.size());
  for_blocks(context, charts.size(), 1, [&](std::size_t d, std::size_t /*end*/) {
    const ChartView chart(charts[d]);
    out[d] = {chart, triangle_kinds(data, chart), fill_square(ChartTriangles(chart))};
  });
  return out;
}

Column<std::uint32_t> first_triangles(std::span<const Chart> charts, std::size_t faces, const ExecutionContext& context) {
  Column<std::uint32_t> triangle_of;
  triangle_of.resize(faces);
  for_blocks(context, charts.size(), 1, [&](std::size_t d, std::size_t /*end*/) {  // a face lies in one chart
    const std::vector<std::uint32_t>& face_of = charts[d].disc.face_of;
    for (std::size_t t = face_of.size(); t-- > 0;) triangle_of[face_of[t]] = static_cast<std::uint32_t>(t);
  });
  return triangle_of;
}

}  // namespace

CurveBase::CurveBase(SurfaceData surface, std::span<const Chart> all_charts, const ExecutionContext& context)
    : data(std::move(surface)),
      charts(base_charts(data, all_charts, context)),
      triangle_of(first_triangles(all_charts, data.mesh.triangles.size(), context)) {
  mappers.reserve(charts.size());
  for (const BaseChart& chart : charts) mappers.emplace_back(data, chart, chart.kinds);
}

CurveBase::CurveBase(SurfaceData surface, std::vector<BaseChart> all_charts, Column<std::uint32_t> face_triangles, Check check,
                     IsThere is_there, bool in_file)
    : data(std::move(surface)),
      charts(std::move(all_charts)),
      triangle_of(std::move(face_triangles)),
      check_(std::move(check)),
      is_there_(std::move(is_there)),
      in_file_(in_file),
      states_(std::make_unique<std::atomic<State>[]>(charts.size())),
      once_(std::make_unique<std::once_flag[]>(charts.size())) {
  mappers.reserve(charts.size());
  for (const BaseChart& chart : charts) mappers.emplace_back(data, chart, chart.kinds);
}

bool CurveBase::check_disc(std::size_t disc) const {
  std::call_once(once_[disc], [&] {
    const absl::Status status = check_(disc);
    if (!status.ok()) {
      const MutexLock lock(mutex_);
      status_.Update(status);
    }
    states_[disc].store(status.ok() ? State::kSound : State::kDamaged, std::memory_order_release);
  });
  return states_[disc].load(std::memory_order_acquire) == State::kSound;
}

bool CurveBase::is_all_sound() const {
  std::atomic<bool> all = true;
  tbb::parallel_for(std::size_t{0}, charts.size(), [&](std::size_t d) {
    if (!is_sound(d)) all = false;
  });
  return all;
}

absl::Status CurveBase::status() const {
  {
    const MutexLock lock(mutex_);
    if (!status_.ok()) return status_;
  }
  return is_there_ ? is_there_() : absl::OkStatus();
}

std::uint64_t CurveBase::byte_size() const {
  const auto bytes = [](const auto&... values) { return (std::uint64_t{0} + ... + std::span(values).size_bytes()); };
  std::uint64_t sum =
      bytes(data.mesh.positions, data.mesh.triangles, data.geometry, data.creases.normals, data.creases.faces, data.borders) +
      triangle_of.size() * sizeof(std::uint32_t);
  for (const std::span<const float> scalar : data.scalars) sum += scalar.size_bytes();
  if (data.colour != nullptr) {
    const ColourView& colour = data.colour->source();
    sum += bytes(colour.colours, colour.uv, colour.face_colours, colour.material_of_face);
  }
  for (const BaseChart& chart : charts) {
    sum += bytes(chart.positions, chart.triangles, chart.twins, chart.face_of, chart.uv) + chart.kinds.size();
  }
  return sum;
}

SurfaceCurve next_revision(const SurfaceCurve& curve) {
  SurfaceCurve next;
  next.origin = curve.origin;
  for (const ScalarColumn& scalar : curve.scalars) next.scalars.push_back({scalar.name, {}});
  next.face_sources = curve.face_sources;
  next.reference_curvature = curve.reference_curvature;
  next.total_area = curve.total_area;
  next.box = curve.box;
  next.max_points = curve.max_points;
  next.revision = curve.revision + 1;
  return next;
}

}  // namespace curvecast
