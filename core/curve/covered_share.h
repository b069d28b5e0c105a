// How much of a square in the parameter domain a triangle covers.
#pragma once

#include "core/base/simd.h"
#include "core/curve/parameter_triangle.h"

namespace curvecast {

/// Returns the share of the square [x, x + 1 / scale] x [y, y + 1 / scale] that a triangle covers, within rounding, by Green's
/// theorem: the integral of x over y around the triangle, in coordinates in which the square is [0, 1]^2, with y cut off and x
/// clamped there. All sides at once, without jumps: nobody can predict where a side passes a square.
[[gnu::always_inline]] inline double covered_share(const UvTriangle& triangle, double x, double y, double scale) {
  // Lanes are the three sides and one of no length. Relative to the square no digits are lost on small leaves.
  const Double4 xa = (Double4{triangle.u[0], triangle.u[1], triangle.u[2], triangle.u[0]} - x) * scale;
  const Double4 ya = (Double4{triangle.v[0], triangle.v[1], triangle.v[2], triangle.v[0]} - y) * scale;
  const Double4 xb = __builtin_shufflevector(xa, xa, 1, 2, 0, 0);
  const Double4 yb = __builtin_shufflevector(ya, ya, 1, 2, 0, 0);
  const Double4 zero{}, one = zero + 1;
  const Double4 rise = yb - ya;
  const Double4 slope = (xb - xa) / (rise != zero ? rise : one);
  Double4 y0 = ya > zero ? ya : zero;
  Double4 y1 = yb > zero ? yb : zero;
  y0 = y0 < one ? y0 : one;
  y1 = y1 < one ? y1 : one;
  const Double4 x0 = xa + slope * (y0 - ya), x1 = xb + slope * (y1 - yb);
  const Double4 low = x0 < x1 ? x0 : x1, high = x0 < x1 ? x1 : x0;
  // The mean of x along the side: what lies between 0 and 1 as a trapezium, and what lies beyond as 1.
  Double4 left = low > zero ? low : zero;
  Double4 right = high > zero ? high : zero;
  left = left < one ? left : one;
  right = right < one ? right : one;
  Double4 beyond = high - (low > one ? low : one);
  beyond = beyond > zero ? beyond : zero;
  const Double4 width = high - low;
  const Double4 mean = width > zero ? (0.5 * (right - left) * (left + right) + beyond) / (width > zero ? width : one) : left;
  const Double4 share = (y1 - y0) * mean;
  return share[0] + share[1] + share[2];
}

}  // namespace curvecast
