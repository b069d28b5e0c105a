#include "core/remesh/surface_walk.h"

#include <algorithm>

namespace curvecast {
namespace {

struct Found {
  double weight_1, weight_2, square;  // of the distance
  int sides;                          // bit i: it lies on side i, from corner i on
};

/// Finds the nearest point of a triangle. Source: Ericson, "Real-Time Collision Detection" (2005), section 5.1.5.
Found nearest_on(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const auto found = [&](double v, double w, int sides) { return Found{v, w, (ap - v * ab - w * ac).squaredNorm(), sides}; };
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return found(0, 0, 0b101);
  const Vec3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return found(1, 0, 0b011);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return found(d1 > d3 ? d1 / (d1 - d3) : 0, 0, 0b001);
  const Vec3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return found(0, 1, 0b110);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return found(0, d2 > d6 ? d2 / (d2 - d6) : 0, 0b100);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double sum = (d4 - d3) + (d5 - d6), w = sum > 0 ? (d4 - d3) / sum : 0;
    return found(1 - w, w, 0b010);
  }
  const double sum = va + vb + vc;
  return sum > 0 ? found(vb / sum, vc / sum, 0) : found(0, 0, 0b111);
}

}  // namespace

WalkPlace SurfaceWalk::place(std::uint32_t face, double weight_1, double weight_2) const {
  const Triangle& t = mesh_.triangles[face];
  const Vec3d& a = mesh_.positions[t[0]];
  const Vec3d position = a + weight_1 * (mesh_.positions[t[1]] - a) + weight_2 * (mesh_.positions[t[2]] - a);
  return {face, weight_1, weight_2, position};
}

Vec3d SurfaceWalk::normal(std::uint32_t face) const {
  const Vec3d normal = area_vector(mesh_, face);
  const double length = normal.norm();
  return length > 0 ? Vec3d(normal / length) : Vec3d(Vec3d::Zero());
}

WalkPlace SurfaceWalk::nearest(std::uint32_t face, const Vec3d& point) const {
  constexpr int kMostSteps = 1000;  // far beyond what a step of relaxation takes
  const auto look = [&](std::uint32_t f) {
    const Triangle& t = mesh_.triangles[f];
    return nearest_on(point, mesh_.positions[t[0]], mesh_.positions[t[1]], mesh_.positions[t[2]]);
  };
  Found best = look(face);
  for (int step = 0; step < kMostSteps && best.sides != 0; ++step) {
    const std::uint32_t here = face;
    const int sides = best.sides;
    const auto take = [&](std::uint32_t f) {
      if (f == here) return;
      const Found other = look(f);
      if (other.square < best.square) best = other, face = f;
    };
    // On one side: the face beyond it. At a corner: all faces around that.
    int corner = -1;
    for (int i = 0; i < 3; ++i) {
      if ((sides >> i & 1) != 0 && (sides >> (i + 2) % 3 & 1) != 0) corner = i;
    }
    if (corner >= 0) {
      fans_.visit(mesh_.triangles[here][corner], [&](std::uint32_t h) { take(h / 3); });
    } else {
      const int side = sides == 1 ? 0 : sides == 2 ? 1 : 2;
      const std::uint32_t twin = mesh_.twins[3 * here + static_cast<std::uint32_t>(side)];
      if (twin != kNone) take(twin / 3);
    }
    if (face == here) break;
  }
  return place(face, best.weight_1, best.weight_2);
}

}  // namespace curvecast
