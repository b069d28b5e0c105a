#include "core/curve/surface_curve.h"

namespace curvecast {

void SurfaceCurve::resize(std::size_t n, bool has_colour) {
  for (std::vector<float>* values : {&x, &y, &z, &nx, &ny, &nz, &curvature_min, &curvature_max, &area}) values->resize(n);
  if (has_colour) colour.resize(n);
  triangle.resize(n);
  key.resize(n);
  level.resize(n);
}

std::size_t SurfaceCurve::byte_size() const {
  constexpr std::size_t kEntry = 9 * sizeof(float) + sizeof(std::uint32_t) + sizeof(std::uint64_t) + sizeof(std::uint8_t);
  return size() * kEntry + colour.size() * sizeof(Rgba8) + disc_begin.size() * sizeof(std::uint32_t);
}

}  // namespace curvecast
