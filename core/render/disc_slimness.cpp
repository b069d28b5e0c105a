#include "core/render/disc_slimness.h"

#include <algorithm>
#include <cmath>

#include "core/base/vec.h"

namespace curvecast {
namespace {

constexpr float kCreaseCosine = 0.766F;  // 40 degrees: what lies beyond is another side
constexpr float kFarthest = 1.6F;        // radii
// Of f / k r. Half of it is where the outline is; what blends reaches as far with less. A quarter less opens gaps, a half more
// lets discs stick out.
constexpr float kStrength = 0.3F;

Vec3f to_vec(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

}  // namespace

float disc_slimness(std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near) {
  const SplatVertex& own = splats[disc];
  const Vec3f centre = to_vec(own.center), normal = to_vec(own.normal);
  const Vec3f to_eye = -centre.normalized();
  const float facing = normal.dot(to_eye);
  Vec3f away = facing * normal - to_eye;  // in the disc's plane
  if (away.squaredNorm() < 1e-8F) return 1;
  away.normalize();
  // The best k of normal change = k * way, both in the direction away from the eye, by least squares.
  float change = 0, squares = 0;
  for (const std::uint32_t other : near) {
    if (other == disc) continue;
    const Vec3f way = to_vec(splats[other].center) - centre, its = to_vec(splats[other].normal);
    if (its.dot(normal) < kCreaseCosine || way.norm() > kFarthest * own.radius) continue;
    const float w = way.dot(away);
    change += w * (its - normal).dot(away);
    squares += w * w;
  }
  if (!(squares > 0)) return 1;
  const float bend = (facing < 0 ? -1.0F : 1.0F) * change / squares * own.radius;
  if (bend <= 0) return 1;
  return std::clamp(kStrength * std::abs(facing) / bend, kLeastSlimness, 1.0F);
}

}  // namespace curvecast
