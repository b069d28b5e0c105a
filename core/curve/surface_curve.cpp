#include "core/curve/surface_curve.h"

#include "core/curve/curve_columns.h"

namespace curvecast {

void SurfaceCurve::resize(std::size_t n, bool has_colour, bool has_beside) {
  visit_columns(*this, [n](const char* /*name*/, auto& column, ColumnLength length) {
    if (length == ColumnLength::kAll) column.resize(n);
  });
  if (has_colour) colour.resize(n);
  if (has_beside) beside.resize(n);
  for (ScalarColumn& scalar : scalars) scalar.values.resize(n);
}

void SurfaceCurve::finish() { blocks = build_blocks(*this); }

std::size_t SurfaceCurve::byte_size() const {
  std::size_t bytes = disc_begin.size() * sizeof(std::uint32_t) + blocks.byte_size() + face_sources.codes().size_bytes();
  const auto add = [&bytes](const auto& column) { bytes += column.size() * sizeof(column[0]); };
  visit_columns(*this, [&](const char* /*name*/, const auto& column, ColumnLength /*length*/) { add(column); });
  for (const ScalarColumn& scalar : scalars) add(scalar.values);
  return bytes;
}

}  // namespace curvecast
