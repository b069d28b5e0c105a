// Points in curve order, and the runs that they come in: discs of a curve, or whatever else jumps in space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec.h"

namespace curvecast {

/// Points where they lie: coordinates of point i are x[i * stride], y[i * stride], z[i * stride].
struct PointView {
  const float *x = nullptr, *y = nullptr, *z = nullptr;
  std::size_t size = 0;
  std::size_t stride = 1;
};
PointView view_of(std::span<const float> x, std::span<const float> y, std::span<const float> z);
PointView view_of(std::span<const Vec3f> points);

/// Points [begin, begin + size).
struct PointPiece {
  std::uint32_t begin, size;
  std::size_t first_leaf = 0;  // for whoever cuts pieces into leaves
};

/// Puts pieces that are neighbours in space side by side, as far as a line allows: along a Z-order curve through their middles.
/// Those whose middle is not finite go anywhere.
void order_in_space(const PointView& points, std::vector<PointPiece>& pieces);

}  // namespace curvecast
