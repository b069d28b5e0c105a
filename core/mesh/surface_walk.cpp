#include "core/mesh/surface_walk.h"

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

SurfaceWalk::End SurfaceWalk::straight(const WalkPlace& from, const Vec3d& step) const {
  constexpr int kMostFaces = 10'000;
  std::uint32_t face = from.face;
  double weights[3] = {1 - from.weight_1 - from.weight_2, from.weight_1, from.weight_2};
  Vec3d left = step;
  std::size_t entered_beside = 3;  // the corner opposite to the edge that the walk came over: it leads away from that
  const auto here = [&](std::uint32_t border) { return End{place(face, weights[1], weights[2]), border}; };
  for (int i = 0; i < kMostFaces; ++i) {
    const Triangle& corners = mesh_.triangles[face];
    const Vec3d& a = mesh_.positions[corners[0]];
    const Vec3d e1 = mesh_.positions[corners[1]] - a, e2 = mesh_.positions[corners[2]] - a;
    const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), determinant = g11 * g22 - g12 * g12;
    if (!(determinant > 0)) break;
    const double r1 = left.dot(e1), r2 = left.dot(e2);
    double change[3] = {0, (g22 * r1 - g12 * r2) / determinant, (g11 * r2 - g12 * r1) / determinant};
    change[0] = -(change[1] + change[2]);
    double part = 1;
    std::size_t out = 3;  // the corner opposite to the edge that the walk leaves over
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == entered_beside || !(change[k] < 0)) continue;
      if (const double until = std::max(0.0, weights[k]) / -change[k]; until < part) part = until, out = k;
    }
    for (std::size_t k = 0; k < 3; ++k) weights[k] = std::clamp(weights[k] + part * change[k], 0.0, 1.0);
    if (out == 3) {
      const double sum = weights[0] + weights[1] + weights[2];
      for (double& weight : weights) weight /= sum;
      return here(kNone);
    }
    const std::size_t begin = (out + 1) % 3, end = (out + 2) % 3;
    weights[out] = 0;
    weights[begin] = 1 - std::min(weights[end], 1.0);
    weights[end] = 1 - weights[begin];
    const std::uint32_t over = 3 * face + static_cast<std::uint32_t>(begin), twin = mesh_.twins[over];
    if (twin == kNone) return here(over);
    // What is left turns about the edge into the plane of the next face.
    left = (1 - part) * (change[1] * e1 + change[2] * e2);
    const Vec3d& origin = mesh_.positions[corners[begin]];
    const Vec3d edge = mesh_.positions[corners[end]] - origin;
    const double squared = edge.squaredNorm();
    const std::size_t next_out = (twin % 3 + 2) % 3;
    Vec3d inwards = mesh_.positions[mesh_.triangles[twin / 3][next_out]] - origin;
    if (!(squared > 0)) break;
    inwards -= inwards.dot(edge) / squared * edge;
    const Vec3d along = left.dot(edge) / squared * edge;
    const double length = inwards.norm();
    if (!(length > 0)) break;
    left = along + (left - along).norm() / length * inwards;
    const double next[2] = {weights[end], weights[begin]};  // the twin goes the other way
    face = twin / 3;
    weights[next_out] = 0;
    weights[twin % 3] = next[0];
    weights[(twin % 3 + 1) % 3] = next[1];
    entered_beside = next_out;
  }
  return here(kNone);
}

}  // namespace curvecast
