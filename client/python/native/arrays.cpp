#include "client/python/native/arrays.h"

#include <absl/strings/str_format.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <limits>

namespace curvecast::python {
namespace {

namespace nb = nanobind;

constexpr std::size_t kMostCorners = std::numeric_limits<std::uint32_t>::max() / 2;

}  // namespace

absl::StatusOr<PolygonSoup> to_soup(const Rows<double, 3>& vertices, const Rows<std::int64_t, 3>& faces,
                                    const nb::object& colours, const nb::dict& scalars) {
  const std::size_t vertex_count = vertices.shape(0), face_count = faces.shape(0);
  if (3 * face_count > kMostCorners || vertex_count > kMostCorners) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d vertices and %d faces are more than 700 million", vertex_count, face_count));
  }
  PolygonSoup soup;
  soup.positions.resize(vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const double value = vertices.data()[3 * v + static_cast<std::size_t>(axis)];
      if (!std::isfinite(value)) return absl::InvalidArgumentError(absl::StrFormat("vertices[%d, %d] is %g", v, axis, value));
      soup.positions[v][axis] = value;
    }
  }
  soup.indices.resize(3 * face_count);
  soup.polygon_begin.resize(face_count + 1);
  for (std::size_t i = 0; i < soup.indices.size(); ++i) {
    const std::int64_t index = faces.data()[i];
    if (index < 0 || static_cast<std::size_t>(index) >= vertex_count) {
      return absl::InvalidArgumentError(
          absl::StrFormat("faces[%d, %d] is %d, and there are %d vertices", i / 3, i % 3, index, vertex_count));
    }
    soup.indices[i] = static_cast<std::uint32_t>(index);
  }
  for (std::size_t f = 0; f <= face_count; ++f) soup.polygon_begin[f] = static_cast<std::uint32_t>(3 * f);
  if (!colours.is_none()) {
    const auto rows = nb::cast<Rows<std::uint8_t, 3>>(colours);
    if (rows.shape(0) != vertex_count) {
      return absl::InvalidArgumentError(absl::StrFormat("there are %d colours for %d vertices", rows.shape(0), vertex_count));
    }
    soup.attributes.colours.resize(vertex_count);
    for (std::size_t v = 0; v < vertex_count; ++v) {
      const std::uint8_t* const colour = rows.data() + 3 * v;
      soup.attributes.colours[v] = {colour[0], colour[1], colour[2], 255};
    }
  }
  for (const auto& [name, values] : scalars) {
    const auto column = nb::cast<Values<float>>(values);
    auto text = nb::cast<std::string>(name);
    if (column.shape(0) != vertex_count) {
      return absl::InvalidArgumentError(
          absl::StrFormat("scalars[\"%s\"] has %d values for %d vertices", text, column.shape(0), vertex_count));
    }
    soup.attributes.scalars.push_back({std::move(text), {column.data(), column.data() + vertex_count}});
  }
  return soup;
}

}  // namespace curvecast::python
