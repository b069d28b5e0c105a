// A point set: samples of a surface, in curve order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/capacity.h"
#include "core/base/colour.h"
#include "core/base/vec.h"

namespace curvecast {

/// The most points of a set.
inline constexpr std::uint64_t kMaxPoints = 4'000'000;

struct PointSet {
  Vec3d origin = Vec3d::Zero();         // positions are relative to this, in the file's units
  std::vector<Vec3f> positions;         // N, in the file's units
  std::vector<Vec3f> normals;           // N, unit length
  std::vector<float> radii;             // N, splat radius from the local density, in the file's units: neighbouring discs overlap
  std::vector<std::uint32_t> vertices;  // N, curve vertex of each point, ascending
  std::vector<std::uint32_t> ranks;     // N, distinct; empty where the points have none (see core/progressive)
  std::vector<Rgba8> colours;           // N, or empty when the mesh has none

  std::size_t size() const { return positions.size(); }
  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [o, p, n, r, v, k, c] = *this;
    return capacity_bytes(p, n, r, v, k, c);
  }
};

}  // namespace curvecast
