#include "core/render/disc_ends.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <numbers>

#include "core/base/vec.h"
#include "core/render/disc_outline.h"

namespace curvecast {
namespace {

constexpr std::size_t kNeighbours = 24;
constexpr std::size_t kLeaf = 16;
constexpr std::size_t kGrain = 1024;
constexpr double kLeastCrease = 5;      // degrees: normals are rounded
constexpr float kSheetCosine = -0.95F;  // beyond, both are sides of something thin, whose planes meet anywhere
constexpr float kReach = 1.4F;          // radii from a disc's middle within which it is drawn
constexpr float kSlack = 0.01F;         // radii that discs overlap by at a crease
constexpr float kFlat = 0.05F;          // radii: heights over a plane that say nothing
constexpr float kOtherLine = 0.87F;     // cosine: lines in directions less alike are two, as at a corner

struct Centres {
  std::span<const SplatVertex> splats;

  std::size_t kdtree_get_point_count() const { return splats.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return splats[i].center[axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Centres>, Centres, 3, std::uint32_t>;

Vec3f to_vec(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// The plane of a neighbour that ends a disc, if it does.
struct End {
  bool is_there = false;
  Vec3f across = Vec3f::Zero();  // unit: in the disc's plane, from its middle to the line
  std::array<float, 4> plane{};
};

End end_by(const SplatVertex& disc, const SplatVertex& other, float crease_cosine) {
  const Vec3f own = to_vec(disc.normal), its = to_vec(other.normal), way = to_vec(other.center) - to_vec(disc.center);
  const float cosine = own.dot(its), reach = std::max(disc.radius, other.radius);
  if (cosine > crease_cosine || cosine < kSheetCosine || way.norm() > disc.radius + other.radius) return {};
  const float its_height = way.dot(own), own_height = -way.dot(its), sine = std::sqrt(1 - cosine * cosine);
  // Of a ridge each middle lies below the other's plane, of a valley above. Else the surface turns between them in some other
  // way.
  const float flat = kFlat * reach;
  if (std::abs(its_height) > flat && std::abs(own_height) > flat && its_height * own_height < 0) return {};
  const bool is_ridge = its_height + own_height < 0;
  if (std::abs(own_height) > kReach * disc.radius * sine || std::abs(its_height) > kReach * other.radius * sine) return {};
  if (std::abs(way.dot(own.cross(its))) > reach * sine) return {};  // too far along the line
  const Vec3f outward = is_ridge ? its : Vec3f(-its);
  const float offset = outward.dot(to_vec(other.center)) + kSlack * disc.radius;
  const Vec3f across = outward - outward.dot(own) * own;
  return {true, across / sine, {outward.x(), outward.y(), outward.z(), offset}};
}

void find_ends(std::span<SplatVertex> splats, const Tree& tree, std::size_t i, float crease_cosine) {
  SplatVertex& disc = splats[i];
  disc.ends = {};
  if (to_vec(disc.normal).isZero()) return;
  std::array<std::uint32_t, kNeighbours> near;
  std::array<float, kNeighbours> squares;
  const std::size_t count = tree.knnSearch(disc.center.data(), kNeighbours, near.data(), squares.data());
  std::size_t found = 0;
  Vec3f first = Vec3f::Zero();
  for (std::size_t k = 0; k < count && found < disc.ends.size(); ++k) {
    if (near[k] == i || to_vec(splats[near[k]].normal).isZero()) continue;
    const End end = end_by(disc, splats[near[k]], crease_cosine);
    if (!end.is_there || (found > 0 && end.across.dot(first) > kOtherLine)) continue;
    if (found == 0) first = end.across;
    disc.ends[found++] = end.plane;
  }
  if (found < disc.ends.size()) disc.ends[found] = disc_outline(splats, i, std::span(near).first(count), crease_cosine);
}

}  // namespace

void find_disc_ends(std::span<SplatVertex> splats, double crease_degrees) {
  const auto crease_cosine = static_cast<float>(std::cos(std::max(crease_degrees, kLeastCrease) * std::numbers::pi / 180));
  const Centres centres{splats};
  const Tree tree(3, centres, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, splats.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) find_ends(splats, tree, i, crease_cosine);
  });
}

}  // namespace curvecast
