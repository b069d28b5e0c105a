// What lies in the file of a surface: a record, and arrays by name. For surface_file.cpp alone.
#pragma once

#include <absl/strings/str_cat.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/curve/curve_base.h"
#include "core/storage/archive.h"

namespace curvecast {

/// What a material is but for its picture.
struct MaterialRecord {
  std::string name;
  std::array<std::uint8_t, 4> colour = {};
  std::uint32_t texture = kNone;  // number of its picture
};

struct TextureRecord {
  std::int32_t width = 0, height = 0;
};

/// What is no array.
struct SurfaceRecord {
  std::string note;
  std::uint64_t scalars = 0;
  std::vector<MaterialRecord> materials;
  std::vector<TextureRecord> textures;
  std::vector<std::uint8_t> fills_square;    // for each chart
  std::vector<std::uint64_t> chart_lengths;  // for each chart the length of each of its arrays
};

template <typename Archive, ConstOr<MaterialRecord> T>
void archive(Archive& fields, T& record) {
  fields(record.name, record.colour, record.texture);
}
template <typename Archive, ConstOr<TextureRecord> T>
void archive(Archive& fields, T& record) {
  fields(record.width, record.height);
}
template <typename Archive, ConstOr<SurfaceRecord> T>
void archive(Archive& fields, T& record) {
  auto& [note, scalars, materials, textures, fills_square, chart_lengths] = record;
  fields(note, scalars, materials, textures, fills_square, chart_lengths);
}

/// How a value lies in a file; Eigen's vectors are plain numbers, but the compiler doesn't know.
template <typename T>
struct StoredValue {
  using Type = T;
};
template <typename Number, int n>
struct StoredValue<Eigen::Matrix<Number, n, 1>> {
  using Type = std::array<Number, n>;
};
template <>
struct StoredValue<VertexGeometry> {
  using Type = std::array<float, sizeof(VertexGeometry) / sizeof(float)>;
};
template <>
struct StoredValue<CreaseNormal> {
  using Type = std::array<std::uint32_t, 4>;
};
template <typename T>
using StoredAs = typename StoredValue<T>::Type;

template <typename T>
std::span<const StoredAs<T>> stored(std::span<const T> values) {
  static_assert(sizeof(StoredAs<T>) == sizeof(T));
  return {reinterpret_cast<const StoredAs<T>*>(values.data()), values.size()};
}
template <typename T>
std::span<const T> restored(std::span<const StoredAs<T>> values) {
  static_assert(sizeof(StoredAs<T>) == sizeof(T) && alignof(T) <= 64);
  return {reinterpret_cast<const T*>(values.data()), values.size()};
}

/// The arrays of a surface but for its charts and pictures, as they lie.
struct SurfaceArrays {
  MeshView mesh;
  std::span<const VertexGeometry> geometry;
  std::span<const std::uint32_t> triangle_of;
  std::span<const CreaseNormal> crease_normals;
  std::span<const CreaseFace> crease_faces;
  std::span<const std::uint32_t> borders;
  ColourView colour;
  std::vector<std::span<const float>> scalars;
};

/// The one list of them.
template <typename Visit>
void visit_arrays(SurfaceArrays& arrays, Visit&& visit) {
  visit("positions", arrays.mesh.positions);
  visit("triangles", arrays.mesh.triangles);
  visit("geometry", arrays.geometry);
  visit("triangles of faces", arrays.triangle_of);
  visit("crease normals", arrays.crease_normals);
  visit("crease faces", arrays.crease_faces);
  visit("borders", arrays.borders);
  visit("colours", arrays.colour.colours);
  visit("corner uv", arrays.colour.uv);
  visit("face colours", arrays.colour.face_colours);
  visit("face materials", arrays.colour.material_of_face);
  for (std::size_t i = 0; i < arrays.scalars.size(); ++i) visit(absl::StrCat("scalar ", i), arrays.scalars[i]);
}

/// A chart's arrays.
struct ChartArrays : ChartView {
  std::span<const std::uint8_t> kinds;
};

/// The one list of them. In files, those of all charts follow each other.
inline constexpr std::size_t kChartArrays = 6;
template <typename Visit>
void visit_chart(ChartArrays& chart, Visit&& visit) {
  visit("disc positions", chart.positions);
  visit("disc triangles", chart.triangles);
  visit("disc twins", chart.twins);
  visit("disc faces", chart.face_of);
  visit("disc uv", chart.uv);
  visit("disc kinds", chart.kinds);
}

inline std::string texture_section(std::size_t i) { return absl::StrCat("texture ", i); }

}  // namespace curvecast
