#include "core/curve/walk.h"

#include <algorithm>
#include <limits>

namespace curvecast {
namespace {

// A walk that has not arrived after this many steps goes in circles, or started far away on a fine mesh.
constexpr int kMaxSteps = 2000;

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

}  // namespace

std::uint32_t find_triangle(const ParameterMesh& mesh, const Vec2d& p, std::uint32_t start) {
  std::uint32_t t = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vec3d weights = mesh.triangles[t].weights(p.x(), p.y());
    if (weights.minCoeff() >= 0) return t;
    // The first side to be tried changes from step to step: a fixed choice can go in circles.
    std::uint32_t across = kNone;
    for (std::uint32_t k = 0; k < 3 && across == kNone; ++k) {
      const std::uint32_t side = (static_cast<std::uint32_t>(step) + k) % 3;
      if (weights[(side + 2) % 3] < 0) across = mesh.twins[3 * t + side];  // the weight of the corner opposite the side
    }
    if (across == kNone) return t;  // beyond the square's border, by rounding
    t = across / 3;
  }
  return search_all(mesh, p);
}

bool touches(const ParameterTriangle& p, const Quad& quad) {
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
