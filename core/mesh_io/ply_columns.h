// Where the numbers of a PLY element go: every property of interest is a column of an array.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/ply_header.h"

namespace curvecast {

/// Into every `step`-th number from `first`; which of the three it points to says what kind of numbers they are.
struct PlyColumn {
  std::size_t property = 0;  // index among those of the element
  std::size_t offset = 0;    // bytes before it in an element without lists
  PlyType type{};
  double* real = nullptr;
  float* single = nullptr;
  std::uint8_t* colour = nullptr;  // 0 .. 255, whatever the type of the property
  std::size_t step = 1;
};

/// Makes a colour channel out of a property of the given type: floating point 0 .. 1, 16 bits 0 .. 65535, else 0 .. 255.
inline std::uint8_t ply_colour(double value, PlyType type) {
  if (!is_integer(type)) value *= 255;
  if (type == PlyType::kUint16) value /= 257;
  return value > 0 ? static_cast<std::uint8_t>((value < 255 ? value : 255) + 0.5) : std::uint8_t{0};
}

inline void put(const PlyColumn& column, std::size_t i, double value) {
  i *= column.step;
  if (column.real != nullptr) column.real[i] = value;
  if (column.single != nullptr) column.single[i] = static_cast<float>(value);
  if (column.colour != nullptr) column.colour[i] = ply_colour(value, column.type);
}

/// `count` numbers of a column out of elements of `stride` bytes at `elements`, from the array's place `first`.
template <class Source>
void copy_column(const PlyColumn& column, const char* elements, std::size_t stride, std::size_t first, std::size_t count) {
  const auto copy = [&]<class T>(T) {
    const char* const p = elements + column.offset;
    const std::size_t begin = first * column.step;
    for (std::size_t i = 0; i < count && column.real != nullptr; ++i) {
      column.real[begin + i * column.step] = static_cast<double>(Source::template at<T>(p + i * stride));
    }
    for (std::size_t i = 0; i < count && column.single != nullptr; ++i) {
      column.single[begin + i * column.step] = static_cast<float>(Source::template at<T>(p + i * stride));
    }
    for (std::size_t i = 0; i < count && column.colour != nullptr; ++i) {
      const T value = Source::template at<T>(p + i * stride);
      if constexpr (sizeof(T) == 1 && T(-1) > T(0)) {
        column.colour[begin + i * column.step] = value;
      } else {
        column.colour[begin + i * column.step] = ply_colour(static_cast<double>(value), column.type);
      }
    }
  };
  switch (column.type) {
    case PlyType::kInt8:
      return copy(std::int8_t{});
    case PlyType::kUint8:
      return copy(std::uint8_t{});
    case PlyType::kInt16:
      return copy(std::int16_t{});
    case PlyType::kUint16:
      return copy(std::uint16_t{});
    case PlyType::kInt32:
      return copy(std::int32_t{});
    case PlyType::kUint32:
      return copy(std::uint32_t{});
    case PlyType::kFloat32:
      return copy(float{});
    case PlyType::kFloat64:
      return copy(double{});
  }
}

/// All columns come in the order of their properties.

/// Makes room for the vertices' positions and attributes in `soup`, and for their texture coordinates in `uv`. Empty when x, y or
/// z is missing. Besides x, y, z it knows nx, ny, nz; red, green, blue, alpha (also with `diffuse_` before them, or r, g, b, a);
/// s and t, u and v, texture_u and texture_v, texture_s and texture_t. All other scalars become named attributes.
std::vector<PlyColumn> vertex_columns(const PlyElement& element, PolygonSoup& soup, std::vector<Vec2f>& uv);

/// Finds the polygons' colours (if there are red, green and blue) and numbers of textures (texnumber), with room made behind
/// those of the soup's polygons so far; the columns count from the soup's first polygon.
std::vector<PlyColumn> face_columns(const PlyElement& element, PolygonSoup& soup, std::vector<float>& texture_numbers);

}  // namespace curvecast
