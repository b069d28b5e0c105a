// Exact area elements: the surface area that lies under each leaf (paper, section 3.4).
#pragma once

#include <cstdint>
#include <span>

#include "core/curve/adaptive_quadtree.h"
#include "core/curve/parameter_triangle.h"

namespace curvecast {

/// What counts as the surface's area around a curve vertex.
enum class AreaElement : std::uint8_t {
  kExact,    // the area under the leaf: area_elements()
  kVoronoi,  // the Voronoi area among its eight neighbours (Meyer et al.)
};

/// Writes the surface area under each leaf to `area` (L entries, squared units): the sum over its triangles of the area that they
/// share in the parameter square, times the triangle's area ratio. Over all leaves they add up to the chart's surface area:
/// returns their sum before they are rounded to floats.
double area_elements(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<float> area);

/// The same where `triangles` are only those that the leaves have. `full`: the chart's fill_square().
double area_elements(std::span<const ParameterTriangle> triangles, bool full, const QuadtreeLeaves& leaves,
                     std::span<float> area);

/// Scales area elements so that they add up to the surface's area in spite of their rounding.
void normalise_areas(double total, std::span<float> area);

}  // namespace curvecast
