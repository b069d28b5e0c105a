// The fields of options and reports, for files (see archive.h).
#pragma once

#include <cstdint>
#include <variant>

#include "core/pipeline/pipeline.h"
#include "core/storage/archive.h"

namespace curvecast {

template <typename Archive, ConstOr<Box3d> T>
void archive(Archive& fields, T& box) {
  fields(box.min, box.max);
}

template <typename Archive, ConstOr<RepairReport> T>
void archive(Archive& fields, T& report) {
  auto& [triangulated, degenerate, duplicate, welded, unused, flipped, nonmanifold, split] = report;
  fields(triangulated, degenerate, duplicate, welded, unused, flipped, nonmanifold, split);
}

template <typename Archive, ConstOr<MeshInfo> T>
void archive(Archive& fields, T& info) {
  auto& [format, file_vertices, file_polygons, vertices, faces, components, genus, boundary_loops, area, box, repairs, attributes,
         crease_degrees, warnings] = info;
  fields(format, file_vertices, file_polygons, vertices, faces, components, genus, boundary_loops, area, box, repairs, attributes,
         crease_degrees, warnings);
}

template <typename Archive, ConstOr<StageSeconds> T>
void archive(Archive& fields, T& seconds) {
  auto& [read, repair, cut, parameterise, curve, map, area, total] = seconds;
  fields(read, repair, cut, parameterise, curve, map, area, total);
}

template <typename Archive, ConstOr<Distortion> T>
void archive(Archive& fields, T& distortion) {
  auto& [p50, p99, p999, max, density_p999, extra_levels_mean, extra_levels_max] = distortion;
  fields(p50, p99, p999, max, density_p999, extra_levels_mean, extra_levels_max);
}

template <typename Archive, ConstOr<PreprocessReport> T>
void archive(Archive& fields, T& report) {
  auto& [mesh, discs, curve_vertices, max_level, flipped_triangles, area_error, distortion, fallback_discs, curve_bytes,
         seconds] = report;
  fields(mesh, discs, curve_vertices, max_level, flipped_triangles, area_error, distortion, fallback_discs, curve_bytes, seconds);
}

template <typename Archive, ConstOr<UniformTerm> T>
void archive(Archive& /*fields*/, T& /*term*/) {}

template <typename Archive, ConstOr<CurvatureTerm> T>
void archive(Archive& fields, T& term) {
  auto& [kind, exponent, floor] = term;
  fields.choice(kind, CurvatureKind::kMax);
  fields(exponent, floor);
}

template <typename Archive, ConstOr<ViewTerm> T>
void archive(Archive& fields, T& term) {
  auto& [s0] = term;
  fields(s0);
}

template <typename Archive, ConstOr<DistanceTerm> T>
void archive(Archive& fields, T& term) {
  auto& [near, far, global, fall] = term;
  fields(near, far, global);
  fields.choice(fall, DistanceFall::kLinear);
}

template <typename Archive, ConstOr<FrustumTerm> T>
void archive(Archive& /*fields*/, T& /*term*/) {}

template <typename Archive, ConstOr<ScreenTerm> T>
void archive(Archive& /*fields*/, T& /*term*/) {}

template <typename Archive, ConstOr<PictureTerm> T>
void archive(Archive& /*fields*/, T& /*term*/) {}

template <typename Archive, ConstOr<AttributeTerm> T>
void archive(Archive& fields, T& term) {
  auto& [name] = term;
  fields(name);
}

template <typename Archive, ConstOr<Dab> T>
void archive(Archive& fields, T& dab) {
  auto& [centre, radius, factor, falloff] = dab;
  fields(centre, radius, factor, falloff);
}

template <typename Archive, ConstOr<BrushTerm> T>
void archive(Archive& fields, T& term) {
  auto& [dabs] = term;
  fields(dabs);
}

template <typename Archive, ConstOr<ExpressionTerm> T>
void archive(Archive& fields, T& term) {
  auto& [text] = term;
  fields(text);
}

template <std::size_t kind = 0>
DensityTerm make_density_term(std::size_t wanted) {
  if constexpr (kind + 1 < std::variant_size_v<DensityTerm>) {
    if (wanted != kind) return make_density_term<kind + 1>(wanted);
  }
  return DensityTerm(std::in_place_index<kind>);
}

template <typename Archive, ConstOr<DensityTerm> T>
void archive(Archive& fields, T& term) {
  auto kind = static_cast<std::uint8_t>(term.index());
  fields.choice(kind, static_cast<std::uint8_t>(std::variant_size_v<DensityTerm> - 1));
  if constexpr (Archive::kReads) term = make_density_term(kind);
  std::visit([&](auto& alternative) { archive(fields, alternative); }, term);
}

template <typename Archive, ConstOr<PreprocessOptions> T>
void archive(Archive& fields, T& options) {
  auto& [points, omega, parameteriser, mapper, area_element, density, seed, chart_faces, crease_degrees] = options;
  fields(points, omega);
  fields.choice(parameteriser, Parameteriser::kCgal);
  fields.choice(mapper, Mapper::kIdBuffer);
  fields.choice(area_element, AreaElement::kVoronoi);
  fields(density);
  fields(seed, chart_faces, crease_degrees);
}

}  // namespace curvecast
