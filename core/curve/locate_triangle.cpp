#include "core/curve/locate_triangle.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/base/simd.h"

namespace curvecast {
namespace {

// A walk that has not arrived after this many steps goes in circles, or started far away on a fine mesh.
constexpr unsigned kMaxSteps = 2000;

/// The triangle in which p lies deepest.
std::uint32_t search_all(const ParameterMesh& mesh, const Vec2d& p) {
  std::uint32_t best = 0;
  double deepest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const double depth = mesh.triangles[t].weights(p.x(), p.y()).minCoeff();
    if (depth > deepest) {
      deepest = depth;
      best = t;
    }
  }
  return best;
}

/// The next triangle on the way to a point that has these weights in t, or kNone where that lies beyond the square's border, by
/// rounding. The first side to be tried changes from step to step: a fixed choice can go in circles.
[[gnu::always_inline]] inline std::uint32_t triangle_across(const ParameterMesh& mesh, std::uint32_t t, const Vec3d& weights,
                                                            unsigned step) {
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t side = (step + k) % 3;
    if (!(weights[(side + 2) % 3] < 0)) continue;  // that of the corner opposite the side
    const std::uint32_t twin = mesh.twins[3 * t + side];
    if (twin != kNone) return twin / 3;
  }
  return kNone;
}

}  // namespace

std::uint32_t find_triangle(const ParameterMesh& mesh, const Vec2d& p, std::uint32_t start) {
  std::uint32_t t = start;
  for (unsigned step = 0; step < kMaxSteps; ++step) {
    const Vec3d weights = mesh.triangles[t].weights(p.x(), p.y());
    if (weights.minCoeff() >= 0) return t;
    const std::uint32_t across = triangle_across(mesh, t, weights, step);
    if (across == kNone) return t;
    t = across;
  }
  return search_all(mesh, p);
}

CURVECAST_WIDE void find_four_triangles(const ParameterMesh& mesh, const double* u, const double* v, std::uint32_t start,
                                        std::uint32_t* found) {
  Double4 pu, pv;
  load_lanes(pu, u);
  load_lanes(pv, v);
  const Double4 zero{};
  unsigned left = 0b1111;  // points not found yet
  std::uint32_t t = start;
  for (unsigned step = 0; step < kMaxSteps; ++step) {
    const UvTriangle triangle = mesh.triangles[t];
    Double4 w[3];
    triangle.weights(pu, pv, w);
    const Mask4 is_inside = (w[0] >= zero) & (w[1] >= zero) & (w[2] >= zero);
    const auto bit = [&](int i) { return static_cast<unsigned>(is_inside[i]) & 1u << i; };
    const unsigned inside = left & (bit(0) | bit(1) | bit(2) | bit(3));
    for (unsigned bits = inside; bits != 0; bits &= bits - 1) found[std::countr_zero(bits)] = t;
    left &= ~inside;
    if (left == 0) return;
    // On towards the first of the others.
    const auto next = static_cast<unsigned>(std::countr_zero(left));
    const std::uint32_t across = triangle_across(mesh, t, {w[0][next], w[1][next], w[2][next]}, step);
    if (across == kNone) {
      found[next] = t;
      left &= left - 1;
    } else {
      t = across;
    }
  }
  for (; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left);
    found[i] = search_all(mesh, {u[i], v[i]});
  }
}

bool touches(const UvTriangle& p, const Quad& quad) {
  const double x = quad.corner.x(), y = quad.corner.y(), side = quad.side;
  const auto [min_u, max_u] = std::minmax({p.u[0], p.u[1], p.u[2]});
  const auto [min_v, max_v] = std::minmax({p.v[0], p.v[1], p.v[2]});
  if (min_u > x + side || max_u < x || min_v > y + side || max_v < y) return false;
  for (int i = 0; i < 3; ++i) {
    const int j = i == 2 ? 0 : i + 1;
    const double a = p.v[i] - p.v[j], b = p.u[j] - p.u[i];  // grows inwards
    // The quad's corner that lies farthest inwards.
    const double qx = a > 0 ? x + side : x;
    const double qy = b > 0 ? y + side : y;
    if (a * (qx - p.u[i]) + b * (qy - p.v[i]) < 0) return false;
  }
  return true;
}

void TouchingTriangles::find(const Quad& quad, std::uint32_t start, std::vector<std::uint32_t>& found) {
  // Those that touch a convex quad hang together across edges that touch it too.
  found.clear();
  seen_.clear();
  const auto see = [&](std::uint32_t t) {
    if (marked_[t]) return;
    marked_[t] = true;
    seen_.push_back(t);
  };
  see(find_triangle(mesh_, quad.corner + Vec2d::Constant(0.5 * quad.side), start));
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const std::uint32_t t = seen_[i];
    // The first counts whatever rounding says: no quad is without a triangle.
    if (i > 0 && !touches(mesh_.triangles[t], quad)) continue;
    found.push_back(t);
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      if (mesh_.twins[h] != kNone) see(mesh_.twins[h] / 3);
    }
  }
  for (const std::uint32_t t : seen_) marked_[t] = false;
  std::sort(found.begin(), found.end());
}

}  // namespace curvecast
