#include "core/render/disc_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/vec.h"

namespace curvecast {
namespace {

// The viewer's disc_bends.ts has the same rule and numbers.
constexpr float kNearby = 1.6F;   // radii: neighbours whose normals tell how the surface bends
constexpr float kFarthest = 2;    // radii: neighbours whose places do
constexpr float kNearest = 0.5F;  // radii: at a smaller distance, a height says nothing
// Where nobody is beyond, a surface that is not flat ends, or has few points since nobody sees it. Of a face, here is the border
// of a sheet.
constexpr float kNobodysBend = 0.5F, kGrazing = 0.5F, kFace = 0.7F;  // the bend of the former, and cosines
constexpr float kFlatCosine = 0.9986F;                               // 3 degrees
constexpr float kEnd = 0.25F;                                        // of f^2 / k: half of where the surface ends
constexpr float kReach = 1.4F;                                       // radii from a disc's middle within which it is drawn

Vec3f to_vec(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

float nobodys_bend(float facing) {
  const float t = std::clamp((kFace - std::abs(facing)) / (kFace - kGrazing), 0.0F, 1.0F);
  return kNobodysBend * t * t * (3 - 2 * t);
}

/// The disc, as the eye sees it.
struct Seen {
  Vec3f centre, normal, to_eye;
  float radius, facing;  // facing: the cosine between normal and direction to the eye
  Vec3f towards;         // unit: in the disc's plane, towards an outline: away from the eye, of a back to it
};

Seen see(const SplatVertex& disc) {
  Seen seen{.centre = to_vec(disc.center), .normal = to_vec(disc.normal), .radius = disc.radius};
  seen.to_eye = -seen.centre.normalized();
  seen.facing = seen.normal.dot(seen.to_eye);
  seen.towards = (seen.facing < 0 ? -1.0F : 1.0F) * (seen.facing * seen.normal - seen.to_eye);
  return seen;
}

/// How far the surface bends on the way of a radius towards an outline: by how much neighbours' normals lean (the best k of
/// lean = k * way, both in that direction, by least squares), or what the places beyond tell. 0 where it is hollow.
float bend_of(const Seen& seen, std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near,
              float crease_cosine) {
  const Vec3f across = seen.normal.cross(seen.towards);
  float lean = 0, squares = 0, arc = std::numeric_limits<float>::infinity();
  bool is_flat = true;
  for (const std::uint32_t other : near) {
    if (other == disc) continue;
    const Vec3f way = to_vec(splats[other].center) - seen.centre, its = to_vec(splats[other].normal);
    const float distance = way.norm(), along = way.dot(seen.towards);
    const bool is_crease = its.dot(seen.normal) < crease_cosine;  // between them, where the disc ends
    if (distance > kFarthest * seen.radius) continue;
    if (along > 0 && along >= std::abs(way.dot(across))) {
      if (is_crease)
        arc = std::min(arc, 0.0F);
      else if (along >= kNearest * seen.radius)
        arc = std::min(arc, -2 * way.dot(seen.normal) / (along * along));
    }
    if (is_crease || distance > kNearby * seen.radius) continue;
    if (its.dot(seen.normal) < kFlatCosine) is_flat = false;
    lean += along * (its - seen.normal).dot(seen.towards);
    squares += along * along;
  }
  const float leaning = squares > 0 ? lean / squares * seen.radius : 0.0F;
  const float fallen = std::isfinite(arc) ? arc * seen.radius : is_flat ? 0.0F : nobodys_bend(seen.facing);
  return std::max({leaning, fallen, 0.0F});
}

}  // namespace

std::array<float, 4> disc_outline(std::span<const SplatVertex> splats, std::size_t disc, std::span<const std::uint32_t> near,
                                  float crease_cosine) {
  Seen seen = see(splats[disc]);
  if (seen.towards.squaredNorm() < 1e-8F || near.empty()) return {};
  seen.towards.normalize();
  const float bend = bend_of(seen, splats, disc, near, crease_cosine),
              extent = std::abs(seen.facing);       // of the disc in the picture, in radii
  const float end = kEnd * extent * extent / bend;  // beyond the middle, in radii
  if (!(end <= kReach * extent)) return {};
  const Vec3f out = (seen.normal - seen.facing * seen.to_eye).normalized();
  return {out.x(), out.y(), out.z(), out.dot(seen.centre) + end * seen.radius};
}

}  // namespace curvecast
