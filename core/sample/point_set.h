// A point set: samples of a surface, in curve order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/capacity.h"
#include "core/base/colour.h"
#include "core/base/vec.h"
#include "core/mesh/face_sources.h"

namespace curvecast {

/// The most points of a set.
inline constexpr std::uint64_t kMaxPoints = 4'000'000;

/// A place on a face of the repaired mesh: barycentric weights of the face's second and third corner.
struct FacePlace {
  std::uint32_t face;
  float weight_1, weight_2;
};

/// The same place on the polygon of the file that the face is, or on the piece of it that the face is where it has more than
/// three corners.
inline FacePlace place_in_file(const FacePlace& place, const FaceSources& sources) {
  const FacePlace as_it_is{sources.polygon(place.face), place.weight_1, place.weight_2};
  return sources.is_turned(place.face) ? FacePlace{as_it_is.face, place.weight_2, place.weight_1} : as_it_is;
}

struct PointSet {
  Vec3d origin = Vec3d::Zero();         // positions are relative to this, in the file's units
  std::vector<Vec3f> positions;         // N, in the file's units
  std::vector<Vec3f> normals;           // N, unit length
  std::vector<float> radii;             // N, splat radius from the local density, in the file's units: neighbouring discs overlap
  std::vector<std::uint32_t> vertices;  // N, ascending: the curve vertex at which a point lies, or in whose leaf
  std::vector<FacePlace> places;        // N; empty: each point lies at its curve vertex, or nobody asked
  std::vector<std::uint32_t> ranks;     // N; empty where the points have none (see core/progressive); 2^32 - 1: that or more
  std::vector<Rgba8> colours;           // N, or empty when the mesh has none
  bool has_moved = false;               // away from their curve vertices: only `places` say where points are

  std::size_t size() const { return positions.size(); }
  /// Bytes allocated, in use or not.
  std::size_t byte_size() const {
    const auto& [o, p, n, r, v, f, k, c, m] = *this;
    return capacity_bytes(p, n, r, v, f, k, c);
  }
};

}  // namespace curvecast
