#include "core/mesh/surface_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/cross.h"

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

/// Lays the faces that a straight way meets out in the plane of the first one, where it is a line: what is kept is the last face,
/// and its edge that the line leaves over, from a corner on the right of it (or on it) to one on the left.
class Layout {
 public:
  Layout(const TriangleMesh& mesh, const WalkPlace& from, const Vec3d& step) : mesh_(mesh) {
    const Triangle& t = mesh.triangles[from.face];
    const Vec3d &origin = mesh.positions[t[0]], e1 = mesh.positions[t[1]] - origin, e2 = mesh.positions[t[2]] - origin;
    const double length = e1.norm();
    const Vec3d x = e1 / length, up = e2 - e2.dot(x) * x;
    const double height = up.norm();
    is_sound_ = length > 0 && height > 0;
    if (!is_sound_) return;
    const std::array<Vec2d, 3> corners{Vec2d(0, 0), Vec2d(length, 0), Vec2d(e2.dot(x), height)};
    start_ = from.weight_1 * corners[1] + from.weight_2 * corners[2];
    way_ = Vec2d(step.dot(x), step.dot(up) / height);
    std::array<double, 3> sides{side(corners[0]), side(corners[1]), side(corners[2])};
    const double doubt = kDoubt * way_.norm() * (length + height);
    for (double& on : sides) on = std::abs(on) > doubt ? on : 0;
    // All on one side: the line touches a corner, or an edge, and goes on from the corner that is farther along it.
    const auto least = std::min_element(sides.begin(), sides.end());
    auto most = std::max_element(sides.begin(), sides.end());
    if (*least > 0) *least = 0;
    if (!(*most > 0)) {
      for (std::size_t i = 0; i < 3; ++i) {
        const auto best = static_cast<std::size_t>(most - sides.begin());
        if (sides[i] == *most && way_.dot(corners[i] - corners[best]) > 0) most = sides.begin() + static_cast<std::ptrdiff_t>(i);
      }
      *most = std::numeric_limits<double>::min();
    }
    std::size_t k = 0;
    while (sides[k] > 0 || !(sides[(k + 1) % 3] > 0)) ++k;
    exit_ = 3 * from.face + static_cast<std::uint32_t>(k);
    right_ = corners[k], left_ = corners[(k + 1) % 3], apex_ = corners[(k + 2) % 3];
    right_side_ = sides[k], left_side_ = sides[(k + 1) % 3];
  }

  /// Whether the first face has an area.
  bool is_sound() const { return is_sound_; }
  std::uint32_t exit() const { return exit_; }
  /// Whether the way ends in the last face.
  bool has_aim() const {
    if (beyond() < 0) return false;
    // Where the edge lies along the line, as near as can be told, what is on the edge need not be between its ends.
    const double left = cross(start_ + way_ - right_, apex_ - right_), area = cross(left_ - right_, apex_ - right_);
    return left >= -kDoubt * area && left <= (1 + kDoubt) * area;
  }

  /// Goes on to the face beyond the edge, which must have one. False, and nothing done, where that has no area.
  bool lay_next() {
    const std::uint32_t twin = mesh_.twins[exit_];
    const Vec3d& right = mesh_.positions[mesh_.to(twin)];
    const Vec3d edge = mesh_.positions[mesh_.from(twin)] - right;
    const Vec3d way = mesh_.positions[mesh_.from(previous_halfedge(twin))] - right;
    const double scale = 1 / edge.squaredNorm(), along = scale * way.dot(edge);
    const double away = std::sqrt(scale * (way - along * edge).squaredNorm());
    if (!(away > 0 && std::isfinite(away))) return false;
    const Vec2d flat = left_ - right_;
    const Vec2d apex = right_ + along * flat + away * Vec2d(flat.y(), -flat.x());
    if (const double on = side(apex); on > 0) {
      apex_ = left_, left_ = apex, left_side_ = on;
      exit_ = next_halfedge(twin);
    } else {
      apex_ = right_, right_ = apex, right_side_ = on;
      exit_ = previous_halfedge(twin);
    }
    return true;
  }

  /// Weights of the last face's corners where the way ends.
  std::array<double, 3> aim() const {
    const Vec2d edge = left_ - right_, to_aim = start_ + way_ - right_, to_apex = apex_ - right_;
    const double area = cross(edge, to_apex);
    const double at_apex = std::clamp(beyond() / area, 0.0, 1.0);
    return weights(std::clamp(cross(to_aim, to_apex) / area, 0.0, 1 - at_apex), at_apex);
  }
  /// And where it meets the edge.
  std::array<double, 3> crossing() const { return weights(right_side_ / (right_side_ - left_side_), 0); }

 private:
  static constexpr double kDoubt = 1e-12;  // so far rounding may go, of the sizes of a face

  /// Above 0: on the left of the line.
  double side(const Vec2d& point) const { return cross(way_, point - start_); }
  /// Below 0: the way ends beyond the edge.
  double beyond() const { return cross(left_ - right_, start_ + way_ - right_); }
  std::array<double, 3> weights(double left, double apex) const {
    std::array<double, 3> all;
    all[exit_ % 3] = std::max(0.0, 1 - left - apex), all[(exit_ + 1) % 3] = left, all[(exit_ + 2) % 3] = apex;
    return all;
  }

  const TriangleMesh& mesh_;
  bool is_sound_;
  Vec2d start_, way_;
  std::uint32_t exit_;         // a halfedge
  Vec2d right_, left_, apex_;  // the last face's corners
  double right_side_, left_side_;
};

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
  // As a rule the way ends in the face that it begins in.
  const Triangle& t = mesh_.triangles[from.face];
  const Vec3d& origin = mesh_.positions[t[0]];
  const Vec3d e1 = mesh_.positions[t[1]] - origin, e2 = mesh_.positions[t[2]] - origin;
  const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), r1 = step.dot(e1), r2 = step.dot(e2);
  const double scale = 1 / (g11 * g22 - g12 * g12);
  const double weight_1 = from.weight_1 + scale * (g22 * r1 - g12 * r2), weight_2 = from.weight_2 + scale * (g11 * r2 - g12 * r1);
  if (weight_1 >= 0 && weight_2 >= 0 && weight_1 + weight_2 <= 1) {
    return {{from.face, weight_1, weight_2, origin + weight_1 * e1 + weight_2 * e2}, kNone};
  }
  Layout layout(mesh_, from, step);
  if (!layout.is_sound()) return {from, kNone};
  const auto end = [&](const std::array<double, 3>& weights, std::uint32_t border) {
    return End{place(layout.exit() / 3, weights[1], weights[2]), border};
  };
  for (int i = 0; i < kMostFaces; ++i) {
    if (layout.has_aim()) return end(layout.aim(), kNone);
    if (mesh_.twins[layout.exit()] == kNone) return end(layout.crossing(), layout.exit());
    if (!layout.lay_next()) break;
  }
  return end(layout.crossing(), kNone);
}

}  // namespace curvecast
