#include "core/render/disc_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/vec.h"

namespace curvecast {
namespace {

constexpr float kCreaseCosine = 0.766F;  // 40 degrees: what lies beyond is another side
constexpr float kFarthest = 1.6F;        // radii: neighbours whose normals tell of the curvature
constexpr float kReach = 1.4F;           // radii from a disc's middle within which it is drawn
// Of f / k r. What blends reaches as far with less than the half of it where the outline is. A quarter less opens gaps, a half
// more lets discs blend from too far.
constexpr float kStrength = 0.3F;
constexpr float kGrazing = 0.5F;  // cosine: seen less flatly, what is last is the border of an open surface
// A neighbour lies beyond a disc, as the eye sees it, from this share of the disc's own extent on.
constexpr float kBeyond = 0.25F;
constexpr float kBeside = 1.2F;  // radii: and no farther than this along the outline
constexpr float kNeighbour = 3;  // radii: and no farther than this at all

Vec3f to_vec(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// The disc, as the eye sees it.
struct Seen {
  Vec3f centre, normal, to_eye;
  float radius, facing;  // facing: the cosine between normal and direction to the eye
  Vec3f away;            // unit: in the disc's plane, away from the eye
  Vec3f out;             // unit: where that is in the picture, towards the outline
};

/// The curvature away from the eye, times the radius: the best k of normal change = k * way, both in that direction, by least
/// squares. 0 where it is hollow, or nothing tells.
float bend_of(const Seen& seen, std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near) {
  float change = 0, squares = 0;
  for (const std::uint32_t other : near) {
    if (other == disc) continue;
    const Vec3f way = to_vec(splats[other].center) - seen.centre, its = to_vec(splats[other].normal);
    if (its.dot(seen.normal) < kCreaseCosine || way.norm() > kFarthest * seen.radius) continue;
    const float w = way.dot(seen.away);
    change += w * (its - seen.normal).dot(seen.away);
    squares += w * w;
  }
  return squares > 0 ? std::max((seen.facing < 0 ? -1.0F : 1.0F) * change / squares * seen.radius, 0.0F) : 0.0F;
}

/// Whether no other disc lies between this one and the outline.
bool is_last(const Seen& seen, std::span<const SplatVertex> splats, std::span<const std::uint32_t> near) {
  const Vec3f along = seen.out.cross(seen.to_eye);
  return std::ranges::none_of(near, [&](std::uint32_t other) {
    const Vec3f way = to_vec(splats[other].center) - seen.centre;
    return way.dot(seen.out) > kBeyond * std::abs(seen.facing) * seen.radius &&
           std::abs(way.dot(along)) < kBeside * seen.radius && way.norm() < kNeighbour * seen.radius;
  });
}

}  // namespace

DiscOutline disc_outline(std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near) {
  Seen seen{.centre = to_vec(splats[disc].center), .normal = to_vec(splats[disc].normal), .radius = splats[disc].radius};
  seen.to_eye = -seen.centre.normalized();
  seen.facing = seen.normal.dot(seen.to_eye);
  seen.away = seen.facing * seen.normal - seen.to_eye;
  if (seen.away.squaredNorm() < 1e-8F || near.empty()) return {};
  seen.away.normalize();
  seen.out = (seen.normal - seen.facing * seen.to_eye).normalized();
  DiscOutline outline;
  const float bend = bend_of(seen, splats, disc, near), extent = std::abs(seen.facing);  // of the disc in the picture, in radii
  float end = std::numeric_limits<float>::infinity();                                    // beyond the middle, in radii
  if (bend > 0) {
    outline.slimness = std::clamp(kStrength * extent / bend, kLeastSlimness, 1.0F);
    end = 0.5F * extent * extent / bend;
  }
  if (extent < kGrazing && end > kLastReach * extent && is_last(seen, splats, near)) end = kLastReach * extent;
  if (end > kReach * extent) return outline;
  outline.plane = {seen.out.x(), seen.out.y(), seen.out.z(), seen.out.dot(seen.centre) + end * seen.radius};
  return outline;
}

}  // namespace curvecast
