#include "core/remesh/angle_flips.h"

#include <cmath>

namespace curvecast {
namespace {

// By which the cotangents of both angles are below zero where an edge is turned: keeps rounding from turning edges to and fro.
constexpr double kSlack = 1e-9;

/// An angle of a triangle, by its cosine and sine times the lengths of its sides.
struct Angle {
  double cosine, sine;

  Angle(const Vec3d& at, const Vec3d& p, const Vec3d& q) {
    const Vec3d a = p - at, b = q - at;
    cosine = a.dot(b);
    sine = a.cross(b).norm();
  }
};

/// Says whether two angles add up to more than 180 degrees: by the sign of the sine of their sum.
bool exceed_half_turn(const Angle& a, const Angle& b, double slack) {
  return a.cosine * b.sine + b.cosine * a.sine < -slack * (std::abs(a.cosine) + a.sine) * (std::abs(b.cosine) + b.sine);
}

}  // namespace

void AngleFlips::add_around(std::uint32_t v) {
  mesh_.for_each_outgoing(v, [&](std::uint32_t h) {
    open_.push_back(h);
    open_.push_back(next_halfedge(h));
  });
}

void AngleFlips::add_all() {
  for (std::uint32_t h = 0; h < mesh_.twins.size(); ++h) {
    if (mesh_.has_face(h / 3) && mesh_.twins[h] < h) open_.push_back(h);
  }
}

bool AngleFlips::wants_flip(std::uint32_t h) const {
  const std::uint32_t t = mesh_.twins[h];
  if (t == kNone) return false;
  const Vec3d &a = mesh_.positions[mesh_.from(h)], &b = mesh_.positions[mesh_.to(h)];
  const Vec3d &c = mesh_.positions[mesh_.apex(h)], &d = mesh_.positions[mesh_.apex(t)];
  const Angle at_c(c, a, b), at_d(d, a, b);
  if (at_c.cosine >= 0 && at_d.cosine >= 0) return false;
  if (!exceed_half_turn(at_c, at_d, kSlack)) return false;
  if (exceed_half_turn(Angle(a, c, d), Angle(b, c, d), 0)) return false;
  const Vec3d before = (b - a).cross(c - a) + (a - b).cross(d - b);
  const Vec3d first = (c - d).cross(a - d), second = (d - c).cross(b - c);
  return first.dot(before) > 0 && second.dot(before) > 0;
}

void AngleFlips::run() {
  // Angles in space may have edges turn in circles, which those in a plane cannot.
  std::size_t left = 16 * open_.size() + 64;
  while (!open_.empty() && left > 0) {
    const std::uint32_t h = open_.back();
    open_.pop_back();
    if (!mesh_.has_face(h / 3) || !wants_flip(h) || !mesh_.may_flip(h)) continue;
    --left;
    const std::uint32_t t = mesh_.twins[h];
    mesh_.flip(h);
    for (const std::uint32_t side : {next_halfedge(h), previous_halfedge(h), next_halfedge(t), previous_halfedge(t)}) {
      open_.push_back(side);
    }
  }
  open_.clear();
}

}  // namespace curvecast
