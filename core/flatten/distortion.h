// How good a parameterisation is: flipped triangles and area distortion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/flatten/disc_mesh.h"

namespace curvecast {

/// Triangles whose uv area is not positive, by an exact test.
std::uint64_t count_flipped(const DiscMesh& disc, const std::vector<Vec2d>& uv);

/// Signed area of triangle t in the parameter square.
double uv_area(const DiscMesh& disc, const std::vector<Vec2d>& uv, std::size_t t);

/// Surface area over uv area of every triangle. Precondition: no triangle is flipped.
std::vector<double> area_ratios(const DiscMesh& disc, const std::vector<Vec2d>& uv);

/// One triangle's part in a surface's distortion.
struct AreaShare {
  double area;   // on the surface
  double ratio;  // surface area over uv area, over the mean
};

struct Distortion {  // max(ratio, 1 / ratio), as quantiles by surface area
  double p50 = 1, p99 = 1, p999 = 1, max = 1;
};

Distortion summarise_distortion(std::vector<AreaShare> shares);

}  // namespace curvecast
